//! From points to pixels: which functions cover each pixel is found once a camera; their light is gathered
//! whenever it changes.
//!
//! Half of the pixels' rows and columns have such rows of functions; the others are interpolated where the
//! surface goes on, and have rows of their own where it does not (slots.wgsl).

use crate::bindings::{Slot, WORKGROUP, buffer, compute, empty_buffer, grid, group, layout, view};
use crate::gbuffer::GBuffer;
use crate::gpu::Gpu;
use crate::scene::LoadedScene;
use crate::scope::Scope;
use crate::shaders;
use crate::timing::Stamps;
use crate::upload::MAX_BINDING;
use bytemuck::{Pod, Zeroable};
use wgpu::{BufferUsages, ShaderStages};

/// Functions of a row at most; more than these cover a pixel only in crowded corners, and the smallest weights go.
const ROW_LENGTH: u32 = 16;
/// Bytes of a row's entry.
const ENTRY: u64 = 4;
/// Rows for single pixels, as a share of all pixels. Past this they are interpolated across edges.
const SINGLE_SHARE: u64 = 5;
/// Such rows of small pictures, in which edges are everywhere: as many as there are pixels, up to so many. So no two pictures
/// of one view differ by which pixel came first.
const LEAST_SINGLES: u64 = 1 << 16;
/// Distance over which light is interpolated between pixels, as a share of the finest support radius.
const REACH: f32 = 0.25;

/// `Slots` in slots.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Slots {
    capacity: u32,
    row_length: u32,
    reach: f32,
    tilts: u32,
}

/// The pipelines.
pub struct DisplayPass {
    find_layout: wgpu::BindGroupLayout,
    gather_layout: wgpu::BindGroupLayout,
    blocks: wgpu::ComputePipeline,
    edges: wgpu::ComputePipeline,
    gather: wgpu::ComputePipeline,
}

/// The rows of one picture size, and the light gathered through them.
pub struct DisplayTarget {
    size: [u32; 2],
    capacity: u32,
    find: wgpu::BindGroup,
    gather: wgpu::BindGroup,
    /// Rows of single pixels that were asked for, functions looked at, kernels evaluated: u32 each.
    pub counts: wgpu::Buffer,
    /// The slot of every pixel that has a row of its own, else 0.
    pub slots: wgpu::Buffer,
    /// Bounced irradiance by slot: RGB, and its tilt (tilt.wgsl).
    pub light: wgpu::Buffer,
}

impl DisplayPass {
    /// Makes the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        let stage = ShaderStages::COMPUTE;
        let find = [
            Slot::Uniform,
            Slot::Uniform,
            Slot::Depth,
            Slot::TextureUint,
            Slot::Read,
            Slot::Read,
            Slot::Read,
            Slot::Write,
            Slot::Write,
            Slot::Write,
        ];
        let find_layout = layout(gpu, "find", stage, &find);
        let gather = [Slot::Uniform, Slot::Uniform, Slot::Read, Slot::Read, Slot::Read, Slot::Write];
        let gather_layout = layout(gpu, "gather", stage, &gather);
        Self {
            blocks: compute(gpu, "blocks", shaders::FIND, &[&find_layout], &[]),
            edges: compute(gpu, "edges", shaders::FIND, &[&find_layout], &[]),
            gather: compute(gpu, "gather", shaders::GATHER, &[&gather_layout], &[]),
            find_layout,
            gather_layout,
        }
    }

    /// Rows for a picture of this size, for the pixels of `gbuffer` as `frame` sees them; for `every_pixel` one of
    /// its own, so that nothing is interpolated.
    pub fn target(
        &self,
        scope: &Scope,
        frame: &wgpu::Buffer,
        gbuffer: &GBuffer,
        scene: &LoadedScene,
        size: [u32; 2],
        every_pixel: bool,
    ) -> DisplayTarget {
        let blocks = size[0].div_ceil(2) as u64 * size[1].div_ceil(2) as u64;
        let pixels = size[0] as u64 * size[1] as u64;
        let some = (pixels / SINGLE_SHARE).max(pixels.min(LEAST_SINGLES));
        let (singles, reach) = if every_pixel { (pixels, 0.0) } else { (some, REACH * scene.finest_radius) };
        let capacity = (blocks + singles).min((MAX_BINDING / 16).max(blocks));
        let row_length = (MAX_BINDING / (ENTRY * capacity)).clamp(1, ROW_LENGTH as u64);
        let layout = Slots {
            capacity: capacity as u32,
            row_length: row_length as u32,
            reach,
            tilts: scene.meta.is_bumpy() as u32,
        };
        let layout = buffer(scope, "slots layout", BufferUsages::UNIFORM, bytemuck::bytes_of(&layout));
        let storage = BufferUsages::STORAGE;
        let rows = empty_buffer(scope, "rows", storage, ENTRY * row_length * capacity);
        let slots = empty_buffer(scope, "slots", storage, 4 * pixels);
        let light = empty_buffer(scope, "light", storage, 16 * capacity);
        let counts =
            empty_buffer(scope, "counts", storage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC, 16);
        let find = group(
            scope,
            "find",
            &self.find_layout,
            &[
                frame.as_entire_binding(),
                layout.as_entire_binding(),
                view(&gbuffer.depth),
                view(&gbuffer.surface),
                scene.upload.points.as_entire_binding(),
                scene.upload.cuts.as_entire_binding(),
                scene.upload.lookup.as_entire_binding(),
                rows.as_entire_binding(),
                slots.as_entire_binding(),
                counts.as_entire_binding(),
            ],
        );
        let gather = group(
            scope,
            "gather",
            &self.gather_layout,
            &[
                frame.as_entire_binding(),
                layout.as_entire_binding(),
                rows.as_entire_binding(),
                counts.as_entire_binding(),
                scene.relight.display.as_entire_binding(),
                light.as_entire_binding(),
            ],
        );
        DisplayTarget { size, capacity: capacity as u32, find, gather, counts, slots, light }
    }

    /// Finds the functions of every row: after the G-buffer has changed.
    pub fn find(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &DisplayTarget,
        stamps: Option<Stamps<'_>>,
    ) {
        encoder.clear_buffer(&target.counts, 0, None);
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("find"),
            timestamp_writes: stamps.map(|s| s.compute()),
        });
        pass.set_bind_group(0, &target.find, &[]);
        let [width, height] = target.size;
        pass.set_pipeline(&self.blocks);
        pass.dispatch_workgroups(width.div_ceil(16), height.div_ceil(16), 1);
        pass.set_pipeline(&self.edges);
        pass.dispatch_workgroups(width.div_ceil(8), height.div_ceil(8), 1);
    }

    /// Gathers the light of every row: after the light or the rows have changed.
    pub fn gather(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &DisplayTarget,
        stamps: Option<Stamps<'_>>,
    ) {
        let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
            label: Some("gather"),
            timestamp_writes: stamps.map(|s| s.compute()),
        });
        pass.set_pipeline(&self.gather);
        pass.set_bind_group(0, &target.gather, &[]);
        let [x, y] = grid(target.capacity.div_ceil(WORKGROUP));
        pass.dispatch_workgroups(x, y, 1);
    }
}
