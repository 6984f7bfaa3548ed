//! Relighting where another solver than the operator computes bounced light: radiosity, antiradiance, transfer for an environment.

use super::plan::{Kernel, STRIDE};
use super::{Relight, Written};
use crate::gpu::Gpu;
use rebounce_shared::diffuse_transfer::DistantLight;

impl Relight {
    /// Whether the scene is for an environment.
    pub fn is_for_environment(&self) -> bool {
        matches!(self.written, Some((Written::Transfer(_), ..)))
    }

    /// Sets the distant light and emission of a scene for an environment; no effect in others.
    pub fn set_distant(&self, gpu: &Gpu, light: DistantLight) {
        if let Some((Written::Transfer(transfer), ..)) = &self.written {
            transfer.set_light(gpu, &self.display, light);
        }
    }

    /// Whether the file has links, or the light of a fixed solution.
    pub fn is_linked(&self) -> bool {
        self.is_linked
    }

    /// Whether bounced light comes from radiosity: only direct light is computed here then.
    pub fn is_by_radiosity(&self) -> bool {
        self.by_radiosity.get()
    }

    /// Sets whether bounced light comes from radiosity. Returns whether that is a change.
    pub fn set_by_radiosity(&self, on: bool) -> bool {
        self.by_radiosity.replace(on) != on
    }

    /// Adds the light straight from the sources to what is displayed: after radiosity has written bounced light there.
    pub fn show_sources(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        for (i, dispatch) in self.plan.iter().enumerate().filter(|(_, d)| d.kernel == Kernel::Show) {
            let Some((pipeline, bind)) =
                self.sources.as_ref().and_then(|own| own.pass(dispatch.kernel, false))
            else {
                continue;
            };
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, bind, &[i as u32 * STRIDE as u32]);
            pass.dispatch_workgroups(dispatch.groups[0], dispatch.groups[1], 1);
        }
    }
}
