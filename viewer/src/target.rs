//! Everything that belongs to a picture of one size.

use crate::bindings::empty_buffer;
use crate::blended::{BlendedTarget, Veil};
use crate::composite::{self, Picture, Sources};
use crate::display::DisplayTarget;
use crate::gbuffer::GBuffer;
use crate::gpu::Gpu;
use crate::pipelines::Pipelines;
use crate::scene::LoadedScene;
use crate::scope::Scope;
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
    /// Blended surfaces, if the scene has any.
    pub blended: Option<BlendedTarget>,
    /// The picture.
    pub picture: Picture,
    own: Scope,
}

/// What a [`Target`] is for.
pub struct Wanted<'a> {
    /// The scene.
    pub scene: &'a LoadedScene,
    /// The automatic exposure.
    pub key: &'a wgpu::Buffer,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Pixels of the screen across one of the picture.
    pub enlarge: u32,
    /// Bounced light is looked up in every pixel.
    pub every_pixel: bool,
}

impl Target {
    /// Makes all of it.
    pub fn new(gpu: &Gpu, pipelines: &Pipelines, wanted: &Wanted<'_>) -> Self {
        let &Wanted { scene, key, size, enlarge, every_pixel } = wanted;
        let own = Scope::new(gpu);
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let frame = empty_buffer(&own, "frame", usage, size_of::<Frame>() as u64);
        let gbuffer = GBuffer::new(&own, size[0], size[1], scene.materials.detailed);
        let display = pipelines.display.target(&own, &frame, &gbuffer, scene, size, every_pixel);
        let shading = composite::shading(&own);
        let veil = (scene.upload.blended_layers > 0).then(|| Veil::new(&own, size));
        let sources = Sources {
            frame: &frame,
            shading: &shading,
            gbuffer: &gbuffer,
            display: &display,
            veil: veil.as_ref().map(|veil| &veil.texture),
            looks: &scene.materials.looks,
            key,
            levels: &scene.relight.levels,
        };
        let picture = pipelines.composite.target(&own, &sources, size);
        let blended =
            veil.map(|veil| pipelines.blended.target(gpu, veil, scene, &frame, &shading, &gbuffer.depth));
        Self {
            size,
            enlarge,
            frame_group: pipelines.gbuffer.frame_group(gpu, &frame),
            frame,
            gbuffer,
            display,
            blended,
            picture,
            own,
        }
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}
