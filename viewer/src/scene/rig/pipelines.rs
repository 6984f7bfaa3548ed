//! Compute pipelines of rigs, independent of a scene.

use crate::gpu::Gpu;
use crate::gpu::bindings::{Slot, compute, layout};
use crate::shaders::{self, Source};
use wgpu::ShaderStages;

/// The pipelines, with the layouts of their bind groups.
#[derive(Clone)]
pub struct RigPipelines {
    pub(super) skin: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
    pub(super) ride: (wgpu::BindGroupLayout, wgpu::ComputePipeline),
}

impl RigPipelines {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        let made = |entry: &str, source: Source, reads: usize| {
            let mut slots = vec![Slot::Uniform];
            slots.extend(std::iter::repeat_n(Slot::Read, reads));
            slots.push(Slot::Write);
            let layout = layout(gpu, entry, ShaderStages::COMPUTE, &slots);
            let pipeline = compute(gpu, entry, source, &[&layout], &[]);
            (layout, pipeline)
        };
        Self { skin: made("skin", shaders::SKIN, 4), ride: made("ride", shaders::RIDE, 3) }
    }
}
