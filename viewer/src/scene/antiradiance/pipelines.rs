//! Compute pipelines of antiradiance, independent of a scene.

use super::BinsUniform;
use super::in_scene::PointsUniform;
use crate::gpu::Gpu;
use crate::gpu::bindings::{ComputeKernel, Slot, kernel};
use crate::shaders::{self, Source};

/// The pipelines, with the layouts of their bind groups.
pub struct AntiradiancePipelines {
    pub(super) gather: ComputeKernel,
    pub(super) sweep: ComputeKernel,
    pub(super) measure: ComputeKernel,
    pub(super) reflect: ComputeKernel,
    pub(super) leave: ComputeKernel,
    pub(super) light_patches: ComputeKernel,
    pub(super) show_patches: ComputeKernel,
}

impl AntiradiancePipelines {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        let uniform = Slot::UniformPart(size_of::<BinsUniform>() as u64);
        let points = Slot::UniformPart(size_of::<PointsUniform>() as u64);
        let made = |entry: &str, source: Source, reads: usize, writes: usize| {
            kernel(gpu, entry, source, (uniform, reads, writes), &[])
        };
        Self {
            gather: made("gather_bins", shaders::GATHER_BINS, 5, 1),
            sweep: made("sweep_bins", shaders::SWEEP_BINS, 6, 2),
            measure: made("measure_bins", shaders::MEASURE_BINS, 4, 1),
            reflect: made("reflect_patches", shaders::REFLECT_PATCHES, 5, 1),
            leave: made("leave_bins", shaders::LEAVE_BINS, 4, 1),
            light_patches: kernel(gpu, "light_patches", shaders::LIGHT_PATCHES, (points, 2, 1), &[]),
            show_patches: kernel(gpu, "show_patches", shaders::SHOW_PATCHES, (points, 4, 1), &[]),
        }
    }
}
