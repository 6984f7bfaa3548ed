//! Everything that belongs to a picture of one size.

use crate::bindings::empty_buffer;
use crate::composite::{CompositePass, Picture};
use crate::gbuffer::{GBuffer, GBufferPass};
use crate::gpu::Gpu;
use crate::scene::LoadedScene;
use crate::splat::{SplatPass, SplatTarget};
use crate::view::Frame;
use wgpu::BufferUsages;

/// Textures, uniforms and bind groups of one picture size and scene.
pub struct Target {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// The camera's uniform.
    pub frame: wgpu::Buffer,
    /// Its bind group for the G-buffer.
    pub frame_group: wgpu::BindGroup,
    /// G-buffer.
    pub gbuffer: GBuffer,
    /// Splat sums.
    pub splats: SplatTarget,
    /// Their bind groups: for all pixels, and for holes.
    pub splat_groups: [wgpu::BindGroup; 2],
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
        splat_pass: &SplatPass,
        composite_pass: &CompositePass,
        scene: &LoadedScene,
        size: [u32; 2],
    ) -> Self {
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let frame = empty_buffer(gpu, "frame", usage, size_of::<Frame>() as u64);
        let gbuffer = GBuffer::new(gpu, size[0], size[1]);
        let splats = splat_pass.target(gpu, &gbuffer, size[0], size[1]);
        let picture = composite_pass.target(gpu, &frame, &gbuffer, &splats, &scene.materials.emission, size);
        Self {
            size,
            frame_group: gbuffer_pass.frame_group(gpu, &frame),
            splat_groups: splat_pass.groups(
                gpu,
                &frame,
                &scene.upload,
                &scene.relight.values,
                &gbuffer,
                &splats,
            ),
            bytes: gbuffer.bytes + splats.bytes + picture.bytes,
            frame,
            gbuffer,
            splats,
            picture,
        }
    }
}
