//! Bounced irradiance at the pixels of another renderer: of places and normals that it drew into a texture.
//!
//! The lookup is that of our own pictures (find.wgsl, gather.wgsl); the result is a texture, for the other renderer's
//! materials to read.

use super::lookup::{LookupPass, LookupTarget};
use super::{SlotBuffers, find_group, find_layout};
use crate::gpu::Gpu;
use crate::gpu::bindings::{Draw, Slot, attachment, empty_buffer, group, layout, opaque, target};
use crate::gpu::scope::Scope;
use crate::scene::GpuScene;
use crate::scene::view::Frame;
use crate::shaders;
use wgpu::{BufferUsages, ShaderStages, TextureFormat};

/// Format of the positions and of the irradiance.
pub const FORMAT: TextureFormat = TextureFormat::Rgba32Float;

/// The pipelines.
pub struct GivenPass {
    find_layout: wgpu::BindGroupLayout,
    lookup: LookupPass,
    layout: wgpu::BindGroupLayout,
    pipeline: wgpu::RenderPipeline,
}

/// Slots, rows and result of one picture size.
pub struct GivenTarget {
    own: Scope,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Bounced irradiance, linear RGB; alpha: the packed tilt of tilt.wgsl, 0 in scenes without normal maps.
    pub irradiance: wgpu::Texture,
    view: wgpu::TextureView,
    frame: wgpu::Buffer,
    slots: SlotBuffers,
    rows: LookupTarget,
    group: wgpu::BindGroup,
}

impl GivenPass {
    /// Creates the pipelines.
    pub fn new(gpu: &Gpu) -> Self {
        let find_layout = find_layout(gpu, [Slot::TextureLoad; 2]);
        let slots = [Slot::Uniform, Slot::Uniform, Slot::Read, Slot::Read];
        let layout = layout(gpu, "irradiance", ShaderStages::FRAGMENT, &slots);
        let pipeline = Draw {
            label: "irradiance",
            source: shaders::IRRADIANCE,
            vertex: "fullscreen",
            targets: &[opaque(FORMAT)],
            layouts: &[&layout],
            ..Default::default()
        }
        .pipeline(gpu);
        Self {
            lookup: LookupPass::new(gpu, &find_layout, shaders::FIND_GIVEN),
            find_layout,
            layout,
            pipeline,
        }
    }

    /// Resources for `positions` of this size: a texture of [`FORMAT`] as place_given.wgsl reads it. `every_pixel` gives
    /// every pixel a slot, without interpolation.
    pub fn target(
        &self,
        gpu: &Gpu,
        scene: &GpuScene,
        positions: &wgpu::TextureView,
        size: [u32; 2],
        every_pixel: bool,
    ) -> GivenTarget {
        let own = Scope::new(gpu);
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let frame = empty_buffer(&own, "frame", usage, size_of::<Frame>() as u64);
        let slots = SlotBuffers::new(&own, scene, size, every_pixel);
        let find = |scope: &Scope, rows: &wgpu::Buffer| {
            // Positions and normals are in one texture.
            let textures = [positions, positions, &scene.upload.no_rest];
            find_group(scope, &self.find_layout, scene, &slots, &frame, textures, rows)
        };
        let rows = self.lookup.target(Scope::new(gpu), &slots, scene, &frame, find);
        let resources = [&frame, &slots.layout, &slots.light, &slots.by_pixel].map(|b| b.as_entire_binding());
        let group = group(&own, "irradiance", &self.layout, &resources);
        let irradiance = target(&own, "irradiance", FORMAT, size[0], size[1]);
        let view = irradiance.create_view(&Default::default());
        GivenTarget { own, size, irradiance, view, frame, slots, rows, group }
    }

    /// After a change of the positions: finds the functions of every slot. Of `frame`, the camera matters for openness
    /// alone.
    pub fn find(&self, gpu: &Gpu, encoder: &mut wgpu::CommandEncoder, target: &GivenTarget, frame: &Frame) {
        let [width, height] = target.size.map(|side| side as f32);
        let frame = Frame { width, height, ..*frame };
        gpu.queue.write_buffer(&target.frame, 0, bytemuck::bytes_of(&frame));
        encoder.clear_buffer(&target.slots.counts, 0, None);
        self.lookup.find(encoder, &target.rows, &target.slots, None);
    }

    /// After [`Self::find`], or after a change of the light at the points: computes the irradiance of every pixel.
    pub fn gather(&self, encoder: &mut wgpu::CommandEncoder, target: &GivenTarget) {
        self.lookup.gather(encoder, &target.rows, &target.slots, None);
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("irradiance"),
            color_attachments: &[attachment(&target.view, true)],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &target.group, &[]);
        pass.draw(0..3, 0..1);
    }
}

impl GivenTarget {
    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes() + self.rows.bytes()
    }
}
