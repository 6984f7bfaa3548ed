//! All resources of a picture of one size.

use super::pipelines::Pipelines;
use crate::gpu::Gpu;
use crate::gpu::bindings::empty_buffer;
use crate::gpu::scope::Scope;
use crate::passes::blended::{BlendedTarget, Veil};
use crate::passes::composite::{self, Picture, PictureSources};
use crate::passes::display::{self, DisplayTarget};
use crate::passes::gbuffer::GBuffer;
#[cfg(feature = "radiosity")]
use crate::passes::lightmap;
#[cfg(feature = "radiosity")]
use crate::passes::reflections::{ReflectionsSources, ReflectionsTarget};
use crate::passes::settings::Way;
use crate::scene::GpuScene;
#[cfg(feature = "radiosity")]
use crate::scene::rest_picture::rest_picture;
use crate::scene::sky::Sky;
use crate::scene::view::Frame;
use wgpu::BufferUsages;

/// Textures, uniforms and bind groups of one picture size and scene.
pub struct Target {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Screen pixels across one pixel of the picture: greater than 1 in a sketch.
    pub enlarge: u32,
    /// The camera's uniform.
    pub frame: wgpu::Buffer,
    /// The camera's bind group for the G-buffer.
    pub frame_group: wgpu::BindGroup,
    /// G-buffer.
    pub gbuffer: GBuffer,
    /// Slots for bounced light, by lookup or splatting.
    pub display: DisplayTarget,
    /// Blended surfaces, if present in the scene.
    pub blended: Option<BlendedTarget>,
    /// Light of the lightmap, if the scene has one.
    #[cfg(feature = "radiosity")]
    pub lightmap: Option<wgpu::TextureView>,
    /// Reflections of glossy surfaces, if the scene has any.
    #[cfg(feature = "radiosity")]
    pub reflections: Option<ReflectionsTarget>,
    /// The picture.
    pub picture: Picture,
    own: Scope,
}

/// Parameters of a [`Target`].
pub struct Wanted<'a> {
    /// The scene.
    pub scene: &'a GpuScene,
    /// The automatic exposure.
    pub key: &'a wgpu::Buffer,
    /// The environment, if there is one.
    pub sky: Option<&'a Sky>,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Screen pixels across one pixel of the picture.
    pub enlarge: u32,
    /// Whether every pixel has its own slot for bounced light.
    pub every_pixel: bool,
    /// Way of filling the slots.
    pub way: Way,
}

impl Target {
    /// Creates all resources.
    pub fn new(gpu: &Gpu, pipelines: &Pipelines, wanted: &Wanted<'_>) -> Self {
        let &Wanted { scene, key, sky, size, enlarge, every_pixel, way } = wanted;
        let own = Scope::new(gpu);
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let frame = empty_buffer(&own, "frame", usage, size_of::<Frame>() as u64);
        let gbuffer = GBuffer::new(&own, size[0], size[1], scene.materials.detailed);
        #[cfg(feature = "radiosity")]
        let gbuffer = gbuffer.with_rest(scene.rig.as_ref().map(|_| rest_picture(&own, size)));
        let from = display::Sources { scene, frame: &frame, gbuffer: &gbuffer };
        let display = pipelines.display.target(&own, from, size, every_pixel, way);
        let shading = composite::shading(&own);
        let veil = (scene.upload.blended_layers > 0).then(|| Veil::new(&own, size, scene.upload.tinted));
        #[cfg(feature = "radiosity")]
        let lightmap = scene.lightmap.as_ref().map(|_| lightmap::picture(&own, size));
        #[cfg(feature = "radiosity")]
        let reflections = scene.gloss.as_ref().zip(display.rows()).map(|(gloss, rows)| {
            let slots = [&display.slots.layout, rows, &display.slots.by_pixel];
            let sky = sky.map(Sky::reflected);
            let from = ReflectionsSources { frame: &frame, gbuffer: &gbuffer, slots, scene, gloss, sky };
            pipelines.reflections.target(&own, &from, size)
        });
        let sources = PictureSources {
            frame: &frame,
            shading: &shading,
            gbuffer: &gbuffer,
            slots: &display.slots,
            veil: veil.as_ref(),
            looks: &scene.materials.looks,
            key,
            levels: &scene.relight.levels,
            ground: &scene.upload.ground,
            sky: sky.map(|sky| &sky.view),
            #[cfg(feature = "radiosity")]
            lightmap: lightmap.as_ref(),
            #[cfg(feature = "radiosity")]
            reflections: reflections.as_ref().map(|target| &target.picture),
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
            #[cfg(feature = "radiosity")]
            lightmap,
            #[cfg(feature = "radiosity")]
            reflections,
            picture,
            own,
        }
    }

    /// Changes the way of filling slots, from the next picture of a view on.
    pub fn set_way(&mut self, gpu: &Gpu, pipelines: &Pipelines, scene: &GpuScene, way: Way) {
        let from = display::Sources { scene, frame: &self.frame, gbuffer: &self.gbuffer };
        pipelines.display.set_way(gpu, &mut self.display, from, way);
    }

    /// Number of screen pixels covered by the picture.
    pub fn screen_pixels(&self) -> u64 {
        self.size.iter().map(|side| (side * self.enlarge) as u64).product()
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes() + self.display.bytes()
    }
}
