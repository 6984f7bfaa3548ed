//! Lookup: finds the functions that cover every slot, with their weights, after a change of the camera; gathers the
//! light of these functions whenever the light changes.

use super::SlotBuffers;
use crate::gpu::Gpu;
use crate::gpu::MAX_BINDING;
use crate::gpu::bindings::{Slot, WORKGROUP, compute, empty_buffer, grid, group, layout};
use crate::gpu::scope::Scope;
use crate::passes::timing::Stamps;
use crate::scene::GpuScene;
use crate::shaders;
use wgpu::{BufferUsages, ShaderStages};

/// Maximum number of functions in a row; only crowded corners have more, and the smallest weights are dropped.
const ROW_LENGTH: u32 = 16;
/// Bytes of a row's entry.
const ENTRY: u64 = 4;

/// Functions in the row of a slot, so that the rows of all `slots` fit one binding.
pub fn row_length(slots: u64) -> u32 {
    (MAX_BINDING / (ENTRY * slots)).clamp(1, ROW_LENGTH as u64) as u32
}

/// The pipelines.
pub struct LookupPass {
    gather_layout: wgpu::BindGroupLayout,
    blocks: wgpu::ComputePipeline,
    edges: wgpu::ComputePipeline,
    gather: wgpu::ComputePipeline,
}

/// The rows of one picture size.
pub struct LookupTarget {
    find: wgpu::BindGroup,
    gather: wgpu::BindGroup,
    /// Rows of functions and weights: slots.wgsl.
    #[cfg(feature = "radiosity")]
    pub rows: wgpu::Buffer,
    own: Scope,
}

impl LookupPass {
    /// Creates the pipelines; `find` is the layout of `source`: [`shaders::FIND`] or [`shaders::FIND_GIVEN`].
    pub fn new(gpu: &Gpu, find: &wgpu::BindGroupLayout, source: shaders::Source) -> Self {
        let [uniform, read] = [Slot::Uniform, Slot::Read];
        let gather = [uniform, uniform, read, read, read, Slot::Write, read, read];
        let gather_layout = layout(gpu, "gather", ShaderStages::COMPUTE, &gather);
        Self {
            blocks: compute(gpu, "blocks", source, &[find], &[]),
            edges: compute(gpu, "edges", source, &[find], &[]),
            gather: compute(gpu, "gather", shaders::GATHER, &[&gather_layout], &[]),
            gather_layout,
        }
    }

    /// Rows for these slots; `find` creates the bind group of find.wgsl.
    pub fn target(
        &self,
        own: Scope,
        slots: &SlotBuffers,
        scene: &GpuScene,
        frame: &wgpu::Buffer,
        find: impl Fn(&Scope, &wgpu::Buffer) -> wgpu::BindGroup,
    ) -> LookupTarget {
        let bytes = ENTRY * slots.row_length as u64 * slots.capacity as u64;
        let rows = empty_buffer(&own, "rows", BufferUsages::STORAGE, bytes);
        let resources = [
            frame.as_entire_binding(),
            slots.layout.as_entire_binding(),
            rows.as_entire_binding(),
            slots.counts.as_entire_binding(),
            scene.relight.display.as_entire_binding(),
            slots.light.as_entire_binding(),
            scene.upload.gains.as_entire_binding(),
            slots.open.as_entire_binding(),
        ];
        let gather = group(&own, "gather", &self.gather_layout, &resources);
        LookupTarget {
            find: find(&own, &rows),
            gather,
            #[cfg(feature = "radiosity")]
            rows,
            own,
        }
    }

    /// Finds the functions of every row.
    pub fn find(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &LookupTarget,
        slots: &SlotBuffers,
        stamps: Option<Stamps<'_>>,
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("find"),
            timestamp_writes: stamps.map(|s| s.compute(true, true)),
        });
        pass.set_bind_group(0, &target.find, &[]);
        let [width, height] = slots.size;
        pass.set_pipeline(&self.blocks);
        pass.dispatch_workgroups(width.div_ceil(16), height.div_ceil(16), 1);
        pass.set_pipeline(&self.edges);
        pass.dispatch_workgroups(width.div_ceil(8), height.div_ceil(8), 1);
    }

    /// Gathers the light of every row.
    pub fn gather(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &LookupTarget,
        slots: &SlotBuffers,
        stamps: Option<Stamps<'_>>,
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("gather"),
            timestamp_writes: stamps.map(|s| s.compute(true, true)),
        });
        pass.set_pipeline(&self.gather);
        pass.set_bind_group(0, &target.gather, &[]);
        let [x, y] = grid(slots.capacity.div_ceil(WORKGROUP));
        pass.dispatch_workgroups(x, y, 1);
    }
}

impl LookupTarget {
    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}
