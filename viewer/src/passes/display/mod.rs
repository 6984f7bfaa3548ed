//! From points to pixels, in one of two [ways](Way): pixels look up the functions that cover them ([`lookup`]), or
//! functions are splatted to the covered pixels ([`splat`]). Both ways compute the light of every *slot*; the
//! picture is the same.
//!
//! [`given`] computes the same light for the pixels of another renderer.
//!
//! Every second row and column of pixels has slots. Other pixels interpolate between slots on continuous surfaces,
//! and have slots of their own at edges (slots.wgsl).

pub mod choice;
#[cfg(feature = "guest")]
pub mod given;
mod lookup;
pub mod quad;
mod splat;

use super::gbuffer::GBuffer;
use super::settings::Way;
use super::timing::Stamps;
use crate::gpu::Gpu;
use crate::gpu::MAX_BINDING;
use crate::gpu::bindings::{Slot, buffer, empty_buffer, group, layout, view};
use crate::gpu::scope::Scope;
use crate::scene::GpuScene;
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use lookup::{LookupPass, LookupTarget};
use splat::{SplatPass, SplatTarget};
use std::cell::OnceCell;
use wgpu::{BufferUsages, ShaderStages};

/// Slots of single pixels, as a share of all pixels. Pixels that are only too far from their neighbours take at most
/// half of them, edges the rest; further single pixels are interpolated.
const SINGLE_SHARE: u64 = 5;
/// Single slots of small pictures, where edges are dense: one and a half for every pixel, up to this number, so that
/// every pixel finds one. Pictures of one view then do not depend on the order in which pixels request slots.
const LEAST_SINGLES: u64 = 3 << 15;
/// Distance over which light is interpolated between pixels, as a share of the finest support radius.
const REACH: f32 = 0.25;

/// Textures of find.wgsl: places, normals, and where the file has what deforms.
#[cfg(feature = "radiosity")]
const TEXTURES: usize = 3;
/// Textures of find.wgsl: places and normals.
#[cfg(not(feature = "radiosity"))]
const TEXTURES: usize = 2;

/// `Slots` in slots.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Slots {
    capacity: u32,
    row_length: u32,
    reach: f32,
    tilts: u32,
}

/// The pipelines of lookup and splatting.
pub struct DisplayPass {
    find_layout: wgpu::BindGroupLayout,
    lookup: LookupPass,
    /// Created on first use.
    splat: OnceCell<SplatPass>,
}

/// Sources of a [`DisplayTarget`].
#[derive(Clone, Copy)]
pub struct Sources<'a> {
    /// The scene.
    pub scene: &'a GpuScene,
    /// The camera's uniform.
    pub frame: &'a wgpu::Buffer,
    /// The camera's G-buffer.
    pub gbuffer: &'a GBuffer,
}

#[cfg(feature = "radiosity")]
impl Sources<'_> {
    /// Where the file has what deforms.
    fn rest(&self) -> &wgpu::TextureView {
        self.gbuffer.rest.as_ref().unwrap_or(&self.scene.upload.no_rest)
    }
}

/// The slots of one picture size, with the buffers and bind groups that fill them.
pub struct DisplayTarget {
    /// The slots.
    pub slots: SlotBuffers,
    made: MadeTarget,
}

/// The slots: written by lookup or splatting, read by the composite pass.
pub struct SlotBuffers {
    size: [u32; 2],
    capacity: u32,
    row_length: u32,
    /// `Slots` in slots.wgsl.
    pub layout: wgpu::Buffer,
    /// u32 counters: requested single-pixel slots; functions tested, or quads drawn; kernels evaluated by lookup.
    pub counts: wgpu::Buffer,
    /// Slot number of every pixel with its own slot, else 0.
    pub by_pixel: wgpu::Buffer,
    /// Bounced irradiance by slot: RGB, and the tilt (tilt.wgsl).
    pub light: wgpu::Buffer,
    /// Received share of the interpolated irradiance: f32 by slot (openness.wgsl).
    pub open: wgpu::Buffer,
}

/// Resources of one way.
#[expect(clippy::large_enum_variant, reason = "there is one a picture")]
enum MadeTarget {
    Lookup(LookupTarget),
    Splat(SplatTarget),
}

impl SlotBuffers {
    /// Buffers for a picture of this size; `every_pixel` gives every pixel a slot, without interpolation.
    fn new(scope: &Scope, scene: &GpuScene, size: [u32; 2], every_pixel: bool) -> Self {
        let blocks = size[0].div_ceil(2) as u64 * size[1].div_ceil(2) as u64;
        let pixels = size[0] as u64 * size[1] as u64;
        let some = (pixels / SINGLE_SHARE).max((pixels * 3 / 2).min(LEAST_SINGLES));
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
    /// Creates the pipelines of lookup.
    pub fn new(gpu: &Gpu) -> Self {
        let find_layout = find_layout(gpu, [Slot::Depth, Slot::TextureUint]);
        Self {
            lookup: LookupPass::new(gpu, &find_layout, shaders::FIND),
            splat: OnceCell::new(),
            find_layout,
        }
    }

    /// Slots for a picture of this size, filled by `way` where possible; `every_pixel` gives every pixel a slot,
    /// without interpolation.
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

    /// Changes the way of filling slots, from the next [`Self::find`] on. Pictures too tall for splatting, and scenes that
    /// need lookup, keep it.
    pub fn set_way(&self, gpu: &Gpu, target: &mut DisplayTarget, from: Sources<'_>, way: Way) {
        if target.way() != way && (way == Way::Lookup || splat::fits(from.scene, target.slots.size)) {
            target.made = self.make(gpu, &target.slots, from, way);
        }
    }

    fn make(&self, gpu: &Gpu, slots: &SlotBuffers, from: Sources<'_>, way: Way) -> MadeTarget {
        // `rows`: the rows of lookup.
        let textures = [
            &from.gbuffer.depth,
            &from.gbuffer.surface,
            #[cfg(feature = "radiosity")]
            from.rest(),
        ];
        let find = |scope: &Scope, rows: &wgpu::Buffer| {
            find_group(scope, &self.find_layout, from.scene, slots, from.frame, textures, rows)
        };
        let own = Scope::new(gpu);
        match way {
            Way::Splat if splat::fits(from.scene, slots.size) => {
                MadeTarget::Splat(self.splat(gpu).target(own, slots, from, find))
            }
            _ => MadeTarget::Lookup(self.lookup.target(own, slots, from.scene, from.frame, find)),
        }
    }

    fn splat(&self, gpu: &Gpu) -> &SplatPass {
        self.splat.get_or_init(|| SplatPass::new(gpu, &self.find_layout))
    }

    /// After a change of the G-buffer: finds the functions that may reach each slot.
    pub fn find(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &DisplayTarget,
        stamps: Option<Stamps<'_>>,
    ) {
        encoder.clear_buffer(&target.slots.counts, 0, None);
        match &target.made {
            MadeTarget::Lookup(made) => self.lookup.find(encoder, made, &target.slots, stamps),
            MadeTarget::Splat(made) => self.splat(gpu).find(encoder, made, &target.slots, stamps),
        }
    }

    /// After [`Self::find`], or after a change of the light at the points: computes the light of every slot.
    pub fn gather(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &DisplayTarget,
        stamps: Option<Stamps<'_>>,
    ) {
        match &target.made {
            MadeTarget::Lookup(made) => self.lookup.gather(encoder, made, &target.slots, stamps),
            MadeTarget::Splat(made) => self.splat(gpu).gather(encoder, made, &target.slots, stamps),
        }
    }
}

/// The layout of find.wgsl, for these textures of the visible surfaces.
#[inline(always)]
fn find_layout(gpu: &Gpu, [places, normals]: [Slot; 2]) -> wgpu::BindGroupLayout {
    let find = [
        Slot::Uniform,
        Slot::Uniform,
        places,
        normals,
        Slot::Read,
        Slot::Read,
        Slot::Read,
        Slot::Write,
        Slot::Write,
        Slot::Write,
        Slot::Write,
        Slot::Read,
        #[cfg(feature = "radiosity")]
        Slot::Uniform,
        #[cfg(feature = "radiosity")]
        Slot::TextureUint,
    ];
    layout(gpu, "find", ShaderStages::COMPUTE, &find)
}

/// The bind group of find.wgsl.
#[inline(always)]
fn find_group(
    scope: &Scope,
    layout: &wgpu::BindGroupLayout,
    scene: &GpuScene,
    slots: &SlotBuffers,
    frame: &wgpu::Buffer,
    textures: [&wgpu::TextureView; TEXTURES],
    rows: &wgpu::Buffer,
) -> wgpu::BindGroup {
    let upload = &scene.upload;
    let resources = [
        frame.as_entire_binding(),
        slots.layout.as_entire_binding(),
        view(textures[0]),
        view(textures[1]),
        upload.points.as_entire_binding(),
        upload.cuts.as_entire_binding(),
        upload.lookup.as_entire_binding(),
        rows.as_entire_binding(),
        slots.by_pixel.as_entire_binding(),
        slots.counts.as_entire_binding(),
        slots.open.as_entire_binding(),
        upload.gains.as_entire_binding(),
        #[cfg(feature = "radiosity")]
        upload.rest.as_entire_binding(),
        #[cfg(feature = "radiosity")]
        view(textures[2]),
    ];
    group(scope, "find", layout, &resources)
}

impl DisplayTarget {
    /// Way of filling the slots.
    pub fn way(&self) -> Way {
        match self.made {
            MadeTarget::Lookup(_) => Way::Lookup,
            MadeTarget::Splat(_) => Way::Splat,
        }
    }

    /// Rows of functions and weights by slot (slots.wgsl), where functions are looked up.
    #[cfg(feature = "radiosity")]
    pub fn rows(&self) -> Option<&wgpu::Buffer> {
        match &self.made {
            MadeTarget::Lookup(made) => Some(&made.rows),
            MadeTarget::Splat(_) => None,
        }
    }

    /// Bytes of the way's own buffers.
    pub fn bytes(&self) -> u64 {
        match &self.made {
            MadeTarget::Lookup(made) => made.bytes(),
            MadeTarget::Splat(made) => made.bytes(),
        }
    }
}
