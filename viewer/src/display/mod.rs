//! From points to pixels, in one of two [ways](Way): pixels look up the functions that cover them ([`lookup`]), or functions
//! are splatted to the pixels that they cover ([`splat`]). Both give every *slot* its light; the picture does not depend on which it was.
//!
//! Half of the pixels' rows and columns have slots; the others are interpolated where the surface goes on, and
//! have slots of their own where it does not (slots.wgsl).

pub mod choice;
mod lookup;
pub mod quad;
mod splat;

use crate::bindings::{Slot, buffer, empty_buffer, group, layout, view};
use crate::gbuffer::GBuffer;
use crate::gpu::Gpu;
use crate::gpu::MAX_BINDING;
use crate::scene::GpuScene;
use crate::scope::Scope;
use crate::settings::Way;
use crate::timing::Stamps;
use bytemuck::{Pod, Zeroable};
use lookup::{LookupPass, LookupTarget};
use splat::{SplatPass, SplatTarget};
use std::cell::OnceCell;
use wgpu::{BufferUsages, ShaderStages};

/// Slots of single pixels, as a share of all pixels. Past this they are interpolated across edges.
const SINGLE_SHARE: u64 = 5;
/// Such slots of small pictures, in which edges are everywhere: as many as there are pixels, up to so many. So no two pictures
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

/// The pipelines of both ways.
pub struct DisplayPass {
    find_layout: wgpu::BindGroupLayout,
    lookup: LookupPass,
    /// Made when first asked for.
    splat: OnceCell<SplatPass>,
}

/// What a [`DisplayTarget`] is made from.
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    /// The scene.
    pub scene: &'a GpuScene,
    /// The camera's uniform.
    pub frame: &'a wgpu::Buffer,
    /// What it sees.
    pub gbuffer: &'a GBuffer,
}

/// The slots of one picture size, and what fills them.
pub struct DisplayTarget {
    /// The slots.
    pub slots: SlotBuffers,
    made: Made,
}

/// What the picture reads, and both ways fill.
pub struct SlotBuffers {
    size: [u32; 2],
    capacity: u32,
    row_length: u32,
    /// `Slots` in slots.wgsl.
    layout: wgpu::Buffer,
    /// Slots of single pixels that were asked for; functions looked at, or quads drawn; kernels evaluated by lookup: u32 each.
    pub counts: wgpu::Buffer,
    /// The slot of every pixel that has one of its own, else 0.
    pub by_pixel: wgpu::Buffer,
    /// Bounced irradiance by slot: RGB, and its tilt (tilt.wgsl).
    pub light: wgpu::Buffer,
    /// Received share of the interpolated irradiance: f32 by slot (openness.wgsl).
    pub open: wgpu::Buffer,
}

/// What one way needs.
enum Made {
    Lookup(LookupTarget),
    Splat(SplatTarget),
}

impl SlotBuffers {
    /// For a picture of this size; for `every_pixel` a slot each, so that nothing is interpolated.
    fn new(scope: &Scope, scene: &GpuScene, size: [u32; 2], every_pixel: bool) -> Self {
        let blocks = size[0].div_ceil(2) as u64 * size[1].div_ceil(2) as u64;
        let pixels = size[0] as u64 * size[1] as u64;
        let some = (pixels / SINGLE_SHARE).max(pixels.min(LEAST_SINGLES));
        let (singles, reach) = if every_pixel { (pixels, 0.0) } else { (some, REACH * scene.finest_radius) };
        let capacity = (blocks + singles).min((MAX_BINDING / 16).max(blocks));
        let row_length = lookup::row_length(capacity);
        let tilts = scene.meta.is_bumpy() as u32;
        let layout = Slots { capacity: capacity as u32, row_length, reach, tilts };
        let storage = BufferUsages::STORAGE;
        let counted = storage | BufferUsages::COPY_DST | BufferUsages::COPY_SRC;
        Self {
            size,
            capacity: capacity as u32,
            row_length,
            layout: buffer(scope, "slots layout", BufferUsages::UNIFORM, bytemuck::bytes_of(&layout)),
            counts: empty_buffer(scope, "counts", counted, 16),
            by_pixel: empty_buffer(scope, "slots", storage, 4 * pixels),
            light: empty_buffer(scope, "light", storage, 16 * capacity),
            open: empty_buffer(scope, "open", storage, 4 * capacity),
        }
    }
}

impl DisplayPass {
    /// Makes the pipelines of lookup.
    pub fn new(gpu: &Gpu) -> Self {
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
            Slot::Write,
            Slot::Read,
        ];
        let find_layout = layout(gpu, "find", ShaderStages::COMPUTE, &find);
        Self { lookup: LookupPass::new(gpu, &find_layout), splat: OnceCell::new(), find_layout }
    }

    /// Slots for a picture of this size, filled in this way where it can be; for `every_pixel` one each, so that nothing is interpolated.
    pub fn target(
        &self,
        scope: &Scope,
        from: Sources<'_>,
        size: [u32; 2],
        every_pixel: bool,
        way: Way,
    ) -> DisplayTarget {
        let slots = SlotBuffers::new(scope, from.scene, size, every_pixel);
        DisplayTarget { made: self.make(scope, &slots, from, way), slots }
    }

    /// Fills the slots in another way, where it can be, from the next [`Self::find`] on. The tallest pictures cannot be
    /// splatted.
    pub fn set_way(&self, gpu: &Gpu, target: &mut DisplayTarget, from: Sources<'_>, way: Way) {
        if target.way() != way && (way == Way::Lookup || splat::fits(target.slots.size)) {
            target.made = self.make(gpu, &target.slots, from, way);
        }
    }

    fn make(&self, gpu: &Gpu, slots: &SlotBuffers, from: Sources<'_>, way: Way) -> Made {
        // `rows`: those of lookup.
        let find = |scope: &Scope, rows: &wgpu::Buffer| {
            let upload = &from.scene.upload;
            let resources = [
                from.frame.as_entire_binding(),
                slots.layout.as_entire_binding(),
                view(&from.gbuffer.depth),
                view(&from.gbuffer.surface),
                upload.points.as_entire_binding(),
                upload.cuts.as_entire_binding(),
                upload.lookup.as_entire_binding(),
                rows.as_entire_binding(),
                slots.by_pixel.as_entire_binding(),
                slots.counts.as_entire_binding(),
                slots.open.as_entire_binding(),
                upload.gains.as_entire_binding(),
            ];
            group(scope, "find", &self.find_layout, &resources)
        };
        let own = Scope::new(gpu);
        match way {
            Way::Splat if splat::fits(slots.size) => {
                Made::Splat(self.splat(gpu).target(own, slots, from, find))
            }
            _ => Made::Lookup(self.lookup.target(own, slots, from, find)),
        }
    }

    fn splat(&self, gpu: &Gpu) -> &SplatPass {
        self.splat.get_or_init(|| SplatPass::new(gpu, &self.find_layout))
    }

    /// After the G-buffer has changed: finds which functions may reach which slots.
    pub fn find(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &DisplayTarget,
        stamps: Option<Stamps<'_>>,
    ) {
        encoder.clear_buffer(&target.slots.counts, 0, None);
        match &target.made {
            Made::Lookup(made) => self.lookup.find(encoder, made, &target.slots, stamps),
            Made::Splat(made) => self.splat(gpu).find(encoder, made, &target.slots, stamps),
        }
    }

    /// After that, or after the light at the points has changed: gives every slot its light.
    pub fn gather(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &DisplayTarget,
        stamps: Option<Stamps<'_>>,
    ) {
        match &target.made {
            Made::Lookup(made) => self.lookup.gather(encoder, made, &target.slots, stamps),
            Made::Splat(made) => self.splat(gpu).gather(encoder, made, &target.slots, stamps),
        }
    }
}

impl DisplayTarget {
    /// How its slots are filled.
    pub fn way(&self) -> Way {
        match self.made {
            Made::Lookup(_) => Way::Lookup,
            Made::Splat(_) => Way::Splat,
        }
    }

    /// Bytes of what belongs to the way alone.
    pub fn bytes(&self) -> u64 {
        match &self.made {
            Made::Lookup(made) => made.bytes(),
            Made::Splat(made) => made.bytes(),
        }
    }
}
