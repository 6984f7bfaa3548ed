//! Light of a fixed solution at all points, as [`from_groups`](rebounce_shared::relight::from_groups): the columns of its
//! light groups times strengths, summed on the CPU after a change of the lights.

use super::Parts;
use super::from_sources::packed;
use crate::gpu::Gpu;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use std::cell::Cell;

/// Columns of a scene.
pub(super) struct FromGroups {
    /// By column: its group, and the irradiance of the points per unit strength.
    columns: Vec<(usize, Vec<Vec3>)>,
    parts: Cell<Parts>,
}

impl FromGroups {
    /// Unpacks the columns.
    pub(super) fn new(scene: &BakedScene) -> Self {
        let all = &scene.light_groups;
        let mut columns = Vec::new();
        for (column, group) in all.column_groups().enumerate() {
            columns.push((group, all.irradiance(group, column, scene.push())));
        }
        Self { columns, parts: Cell::new(Parts::ALL) }
    }

    /// Sets what of the light is displayed, from the next strengths on.
    pub(super) fn set_parts(&self, parts: Parts) {
        self.parts.set(parts);
    }

    /// Writes the light of all points to `display`, for the strength of each group, linear RGB.
    pub(super) fn set_strengths(&self, gpu: &Gpu, display: &wgpu::Buffer, strengths: &[Vec3]) {
        let Parts { bounced, from_sources } = self.parts.get();
        // Where the light comes from is not known: no tilt.
        let dark = Vec3::ZERO.extend(packed(Vec3::ZERO));
        let mut rows = vec![dark; self.columns.first().map_or(0, |(_, irradiance)| irradiance.len())];
        for (column, (group, irradiance)) in self.columns.iter().enumerate() {
            // Columns of direct light follow those of bounced light.
            let is_shown = if column < strengths.len() { bounced } else { from_sources };
            let strength = strengths[*group] * f32::from(is_shown);
            for (row, e) in rows.iter_mut().zip(irradiance) {
                *row += (strength * *e).extend(0.0);
            }
        }
        gpu.queue.write_buffer(display, 0, bytemuck::cast_slice(&rows));
    }
}
