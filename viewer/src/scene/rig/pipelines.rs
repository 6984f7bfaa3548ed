//! Compute pipelines of rigs, independent of a scene.

use crate::gpu::Gpu;
use crate::gpu::bindings::{ComputeKernel, Slot, kernel};
use crate::shaders::{self, Source};

/// The pipelines, with the layouts of their bind groups.
#[derive(Clone)]
pub struct RigPipelines {
    pub(super) skin: ComputeKernel,
    pub(super) ride: ComputeKernel,
}

impl RigPipelines {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        let made = |entry: &str, source: Source, reads: usize| {
            kernel(gpu, entry, source, (Slot::Uniform, reads, 1), &[])
        };
        Self { skin: made("skin", shaders::SKIN, 4), ride: made("ride", shaders::RIDE, 3) }
    }
}
