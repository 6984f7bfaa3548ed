//! Light of a file for an environment at all points, by [diffuse transfer](rebounce_shared::diffuse_transfer): computed on the
//! CPU after a change of distant light.

use super::Parts;
use super::from_sources::packed;
use crate::gpu::Gpu;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::diffuse_transfer::{DistantLight, Received, TransferField};
use std::cell::{Cell, RefCell};

/// Transfer of a scene, and the light that it was last applied to.
pub(super) struct FromTransfer {
    field: TransferField,
    /// Whether pixels have normals of their own.
    is_bumpy: bool,
    parts: Cell<Parts>,
    light: RefCell<Option<(DistantLight, Parts)>>,
}

impl FromTransfer {
    /// Takes over the transfer of a scene.
    pub(super) fn new(scene: &BakedScene) -> Self {
        Self {
            field: TransferField::new(scene),
            is_bumpy: scene.meta.is_bumpy(),
            parts: Cell::new(Parts::ALL),
            light: RefCell::default(),
        }
    }

    /// Sets what of the light is displayed, from the next light on.
    pub(super) fn set_parts(&self, parts: Parts) {
        self.parts.set(parts);
    }

    /// Writes the light of all points to `display`.
    pub(super) fn set_light(&self, gpu: &Gpu, display: &wgpu::Buffer, light: DistantLight) {
        let parts = self.parts.get();
        if self.light.borrow().as_ref().is_some_and(|(known, shown)| (known, shown) == (&light, &parts)) {
            return;
        }
        let received = self.field.irradiance(&light);
        let tilts = if self.is_bumpy { self.field.tilts(&light, &received) } else { Vec::new() };
        let row = |(i, Received { direct, bounced }): (usize, &Received)| {
            let shown = *direct * f32::from(parts.from_sources) + *bounced * f32::from(parts.bounced);
            shown.extend(packed(tilts.get(i).copied().unwrap_or_default()))
        };
        let rows: Vec<_> = received.iter().enumerate().map(row).collect();
        gpu.queue.write_buffer(display, 0, bytemuck::cast_slice(&rows));
        self.light.replace(Some((light, parts)));
    }

    /// Forgets the light: the points are dark.
    pub(super) fn forget(&self) {
        self.light.replace(None);
    }
}
