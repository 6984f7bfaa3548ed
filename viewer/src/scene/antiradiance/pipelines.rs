//! Compute pipelines of antiradiance, independent of a scene.

use super::BinsUniform;
use crate::gpu::Gpu;
use crate::gpu::bindings::{Slot, compute, layout};
use crate::shaders::{self, Source};
use wgpu::ShaderStages;

/// The pipelines, with the layouts of their bind groups.
pub struct AntiradiancePipelines {
    pub(super) gather: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    pub(super) sweep: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    pub(super) measure: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    pub(super) reflect: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    pub(super) leave: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
}

impl AntiradiancePipelines {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        let made = |entry: &str, source: Source, reads: usize, writes: usize| {
            let mut slots = vec![Slot::UniformPart(size_of::<BinsUniform>() as u64)];
            slots.extend(std::iter::repeat_n(Slot::Read, reads));
            slots.extend(std::iter::repeat_n(Slot::Write, writes));
            let layout = layout(gpu, entry, ShaderStages::COMPUTE, &slots);
            let pipeline = compute(gpu, entry, source, &[&layout], &[]);
            (layout, pipeline)
        };
        Self {
            gather: made("gather_bins", shaders::GATHER_BINS, 5, 1),
            sweep: made("sweep_bins", shaders::SWEEP_BINS, 6, 2),
            measure: made("measure_bins", shaders::MEASURE_BINS, 4, 1),
            reflect: made("reflect_patches", shaders::REFLECT_PATCHES, 5, 1),
            leave: made("leave_bins", shaders::LEAVE_BINS, 4, 1),
        }
    }
}
