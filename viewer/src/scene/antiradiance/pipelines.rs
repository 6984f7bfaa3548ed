//! Compute pipelines of antiradiance, independent of a scene.

use super::BinsUniform;
use super::in_scene::PointsUniform;
use crate::gpu::Gpu;
use crate::gpu::bindings::{ComputeKernel, Slot, compute, kernel, layout};
use crate::shaders::{self, Source};
use std::cell::OnceCell;

/// The pipelines, with the layouts of their bind groups.
pub struct AntiradiancePipelines {
    pub(super) gather: ComputeKernel,
    pub(super) sweep: ComputeKernel,
    pub(super) measure: ComputeKernel,
    pub(super) reflect: ComputeKernel,
    pub(super) arrive_lobes: ComputeKernel,
    pub(super) reflect_lobes: ComputeKernel,
    pub(super) leave: ComputeKernel,
    pub(super) light_patches: ComputeKernel,
    pub(super) show_patches: ComputeKernel,
    pub(super) change_patches: ComputeKernel,
    /// Made for the first scene with metals.
    direct_lobes: OnceCell<ComputeKernel>,
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
            arrive_lobes: made("arrive_lobes", shaders::ARRIVE_LOBES, 6, 1),
            reflect_lobes: made("reflect_lobes", shaders::REFLECT_LOBES, 5, 1),
            leave: made("leave_bins", shaders::LEAVE_BINS, 4, 1),
            light_patches: kernel(gpu, "light_patches", shaders::LIGHT_PATCHES, (points, 2, 1), &[]),
            show_patches: kernel(gpu, "show_patches", shaders::SHOW_PATCHES, (points, 4, 1), &[]),
            change_patches: kernel(gpu, "change_patches", shaders::CHANGE_PATCHES, (points, 6, 2), &[]),
            direct_lobes: OnceCell::new(),
        }
    }

    /// The kernel of direct_lobes.wgsl; `lights` is the layout of the lights' bind group.
    pub(super) fn direct_lobes(&self, gpu: &Gpu, lights: &wgpu::BindGroupLayout) -> &ComputeKernel {
        self.direct_lobes.get_or_init(|| {
            let mut slots = vec![Slot::UniformPart(size_of::<PointsUniform>() as u64)];
            slots.extend([Slot::Read; 4]);
            slots.push(Slot::Write);
            let layout = layout(gpu, "direct_lobes", wgpu::ShaderStages::COMPUTE, &slots);
            let pipeline = compute(gpu, "direct_lobes", shaders::DIRECT_LOBES, &[&layout, lights], &[]);
            (layout, pipeline)
        })
    }
}
