//! Everything that belongs to a picture of one size.

use crate::bindings::empty_buffer;
use crate::composite::{CompositePass, Picture};
use crate::display::{DisplayPass, DisplayTarget};
use crate::gbuffer::{GBuffer, GBufferPass};
use crate::gpu::Gpu;
use crate::scene::LoadedScene;
use crate::view::Frame;
use wgpu::BufferUsages;

/// Textures, uniforms and bind groups of one picture size and scene.
pub struct Target {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Pixels of the screen across one of the picture: 2 in a sketch.
    pub enlarge: u32,
    /// The camera's uniform.
    pub frame: wgpu::Buffer,
    /// Its bind group for the G-buffer.
    pub frame_group: wgpu::BindGroup,
    /// G-buffer.
    pub gbuffer: GBuffer,
    /// Which functions cover which pixels, and their light.
    pub display: DisplayTarget,
    /// The picture.
    pub picture: Picture,
    /// Bytes of all textures.
    pub bytes: u64,
}

impl Target {
    /// Makes all of it.
    pub fn new(
        gpu: &Gpu,
        gbuffer_pass: &GBufferPass,
        display_pass: &DisplayPass,
        composite_pass: &CompositePass,
        scene: &LoadedScene,
        size: [u32; 2],
        enlarge: u32,
    ) -> Self {
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let frame = empty_buffer(gpu, "frame", usage, size_of::<Frame>() as u64);
        let gbuffer = GBuffer::new(gpu, size[0], size[1], scene.materials.detailed);
        let display = display_pass.target(gpu, &frame, &gbuffer, scene, size);
        let picture = composite_pass.target(gpu, &frame, &gbuffer, &display, &scene.materials.looks, size);
        Self {
            size,
            enlarge,
            frame_group: gbuffer_pass.frame_group(gpu, &frame),
            bytes: gbuffer.bytes + display.bytes + picture.bytes,
            frame,
            gbuffer,
            display,
            picture,
        }
    }
}
