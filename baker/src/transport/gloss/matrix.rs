//! The transfer matrix of a point, by [rays](super::rays): for directions ω of equal solid angle Ω over the point,
//!
//! ```text
//! T_ij = Ω Σ (y_i(ω) + y_i(ω')) (V(ω) y_j(ω) + (1 − V(ω)) ρ/π E_j(ω)),   V_i = Ω Σ (y_i(ω) + y_i(ω')) V(ω)
//! ```
//!
//! with ω mirrored at the tangent plane as ω', V whether the environment is seen, and ρ and E_j the reflectance and the
//! irradiance by function j where a ray ends; of a metal, what its [lobe](super::neighbour) gathers. Where bounced light comes by links there is V alone.

use super::GlossSettings;
use super::neighbour::Neighbours;
use super::rays::{PointRay, PointRays};
use super::sky_irradiance::SkyIrradiance;
use crate::geometry::Surfaces;
use rebounce_shared::harmonics::{COUNT, evaluate};
use std::f32::consts::TAU;

/// Entries of the matrices of three channels.
const MATRICES: usize = 3 * COUNT * COUNT;

/// The matrices of red, green and blue by rows, if any; then the coefficients of visibility.
pub(super) type MatrixVector = Box<[f32]>;

/// Computes matrices.
pub(super) struct MatrixGather<'a, S: ?Sized> {
    rays: &'a PointRays<'a, S>,
    /// `None` for visibility alone.
    irradiance: Option<SkyIrradiance>,
    /// What rays meet.
    neighbours: Neighbours<'a, S>,
    /// Whether matrices hold light that did not bounce.
    has_direct: bool,
}

impl<'a, S: Surfaces + ?Sized> MatrixGather<'a, S> {
    /// Gathers with these rays; without `irradiance` visibility alone.
    pub fn new(
        rays: &'a PointRays<'a, S>,
        irradiance: Option<SkyIrradiance>,
        settings: &GlossSettings,
    ) -> Self {
        let neighbours = Neighbours { surfaces: rays.surfaces(), metals: settings.metals };
        Self { rays, irradiance, neighbours, has_direct: settings.has_direct }
    }

    /// Entries of a vector.
    pub fn dimensions(&self) -> usize {
        COUNT + if self.irradiance.is_some() { MATRICES } else { 0 }
    }

    /// Returns the matrix of a point, and the number of rays.
    pub fn matrix(&self, point: usize) -> (MatrixVector, u64) {
        let normal = self.rays.points().points[point].normal;
        let mut out: MatrixVector = vec![0.0; self.dimensions()].into();
        let (matrices, visibility) = out.split_at_mut(self.dimensions() - COUNT);
        let mut open = [[0.0; COUNT]; COUNT];
        let mut all = [0.0; COUNT];
        let solid_angle = self.rays.solid_angle();
        let mut weights = Vec::new();
        let (mut number, mut more) = (0, 0);
        let rays = self.rays.cast(point, |PointRay { direction, way, y }, hit| {
            number += 1;
            let below = evaluate(direction.reflect(normal));
            let received: [f32; COUNT] = std::array::from_fn(|i| solid_angle * (y[i] + below[i]));
            all.iter_mut().zip(received).for_each(|(sum, r)| *sum += r);
            let Some(hit) = hit else {
                for ((row, sum), r) in open.iter_mut().zip(&mut *visibility).zip(received) {
                    row.iter_mut().zip(y).for_each(|(entry, y)| *entry += r * y);
                    *sum += r;
                }
                return;
            };
            let Some(irradiance) = &self.irradiance else { return };
            let (sent, rays) = self.neighbours.radiance(irradiance, &hit, (way, number), &mut weights);
            more += rays;
            for (i, r) in received.iter().enumerate() {
                for (j, sent) in sent.iter().enumerate() {
                    let light = *sent * *r;
                    matrices[i * COUNT + j] += light.x;
                    matrices[(COUNT + i) * COUNT + j] += light.y;
                    matrices[(2 * COUNT + i) * COUNT + j] += light.z;
                }
            }
        });
        if self.has_direct {
            for channel in matrices.chunks_exact_mut(COUNT * COUNT) {
                channel.iter_mut().zip(open.as_flattened()).for_each(|(entry, open)| *entry += open);
            }
        }
        // A control variate: directions are not as evenly spread above a plane as over the sphere, where an open point sees 1.
        let share = visibility[0] / all[0];
        for (i, (v, all)) in visibility.iter_mut().zip(all).enumerate() {
            *v += share * (if i == 0 { (2.0 * TAU).sqrt() } else { 0.0 } - all);
        }
        (out, rays + more)
    }
}

#[cfg(test)]
mod tests;
