//! Composite pass: shading from G-buffer, lights and bounced light; automatic exposure; tone mapping.

use super::blended::Veil;
use super::display::SlotBuffers;
use super::gbuffer::GBuffer;
use crate::gpu::Gpu;
use crate::gpu::bindings::{
    Draw, Slot, WORKGROUP, around, attachment, bilinear, blended, buffer, compute, empty_buffer, group,
    layout, opaque, target, view,
};
use crate::gpu::scope::Scope;
use crate::scene::sky::MOST_SKIES;
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use std::cell::{OnceCell, RefCell};
use wgpu::{BlendFactor, BlendOperation, BufferUsages, ShaderStages, TextureFormat};

/// Format of the averaged picture.
const PICTURE: TextureFormat = TextureFormat::Rgba16Float;

/// `Shading` in shade.wgsl.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Shading {
    /// 1 to show direct light.
    pub direct: f32,
    /// 1 to show bounced light.
    pub indirect: f32,
    /// Number of lights.
    pub lights: u32,
    /// 2^EV.
    pub exposure: f32,
    /// Share of this picture in the average so far.
    pub blend: f32,
    /// G-buffer pixels across one output pixel of [`CompositePass::indirect`].
    pub scale: u32,
    /// [`DETAILED`], [`AGX`], [`MANUAL`], [`VEILED`], [`TINTED`], [`UNLIT`], [`BACKDROP`], [`SMOOTH`].
    pub flags: u32,
    /// Screen pixels across one pixel of the picture.
    pub enlarge: u32,
    /// Factor on the radiance of blended surfaces: see [`crate::scene::blended_fit::unit`].
    pub unit: f32,
    /// Number of skies behind the scene, at most [`MOST_SKIES`].
    pub skies: u32,
    /// Mip level of the background.
    pub sky_level: f32,
    /// Unused.
    pub pad: u32,
    /// By sky: factor of the texture, RGB, and rotation in radians.
    pub sky: [[f32; 4]; MOST_SKIES],
}

/// The scene has detail textures, beyond base colour and transmission.
pub const DETAILED: u32 = 1;
/// Tone mapping by AgX instead of Khronos PBR Neutral.
pub const AGX: u32 = 2;
/// The exposure is set manually.
pub const MANUAL: u32 = 4;
/// The scene has blended surfaces.
pub const VEILED: u32 = 8;
/// The blended surfaces have colours.
pub const TINTED: u32 = 16;
/// Some surfaces are unlit.
pub const UNLIT: u32 = 32;
/// A backdrop is drawn behind all surfaces.
pub const BACKDROP: u32 = 64;
/// Edges are smoothed when the picture is presented.
pub const SMOOTH: u32 = 128;
/// The file has a lightmap.
#[cfg(feature = "radiosity")]
pub const CHARTED: u32 = 256;

/// The file has glossy transfer, and all light is shown.
#[cfg(feature = "radiosity")]
pub const GLOSSY: u32 = 512;

/// The pipelines.
pub struct CompositePass {
    layout: wgpu::BindGroupLayout,
    picture: wgpu::RenderPipeline,
    look: (wgpu::ComputePipeline, wgpu::BindGroupLayout),
    key: (wgpu::ComputePipeline, wgpu::BindGroupLayout),
    /// Created on first use, with the layouts below.
    indirect: OnceCell<wgpu::RenderPipeline>,
    lights: wgpu::BindGroupLayout,
    before_layout: wgpu::BindGroupLayout,
    present_layout: wgpu::BindGroupLayout,
    bilinear: wgpu::Sampler,
    /// Wraps around in x, interpolates between mip levels.
    around: wgpu::Sampler,
    present: RefCell<Vec<(TextureFormat, wgpu::RenderPipeline)>>,
}

/// Number of pixels sampled by the automatic exposure.
const LOOKED: u32 = 64 * 64;

/// Byte offset of the scene's initial exposure in the buffer that [`key`] creates.
pub const FIRST_KEY: u64 = 4;

/// Creates the buffer of the automatic exposure, four floats: the factor on radiance; the factor when the scene was
/// first shown, 0 while unknown; the upper limit of the factor, 0 if the light of the scene sets no limit; unused.
pub fn key(scope: &Scope) -> wgpu::Buffer {
    let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
    buffer(scope, "key", usage, bytemuck::bytes_of(&[1f32, 0.0, 0.0, 0.0]))
}

/// The uniform [`Shading`] of one picture size.
pub fn shading(scope: &Scope) -> wgpu::Buffer {
    let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
    empty_buffer(scope, "shading", usage, size_of::<Shading>() as u64)
}

/// PictureSources of a [`Picture`].
pub struct PictureSources<'a> {
    /// The camera's uniform.
    pub frame: &'a wgpu::Buffer,
    /// The uniform from [`shading`].
    pub shading: &'a wgpu::Buffer,
    /// Opaque surfaces.
    pub gbuffer: &'a GBuffer,
    /// Bounced light of the opaque surfaces.
    pub slots: &'a SlotBuffers,
    /// Blended surfaces, if present.
    pub veil: Option<&'a Veil>,
    /// `MaterialRecord` of the shaders for every material.
    pub looks: &'a wgpu::Buffer,
    /// The exposure buffer from [`key`].
    pub key: &'a wgpu::Buffer,
    /// Light levels of the scene: [`crate::scene::relight::Relight::levels`].
    pub levels: &'a wgpu::Buffer,
    /// `Ground` of backdrop.wgsl, from [`uniform`](crate::scene::ground::uniform).
    pub ground: &'a wgpu::Buffer,
    /// Equirectangular radiance behind the scene, if present.
    pub sky: Option<&'a wgpu::TextureView>,
    /// Light of the lightmap, if there is one.
    #[cfg(feature = "radiosity")]
    pub lightmap: Option<&'a wgpu::TextureView>,
    /// Reflections of glossy surfaces, if there are any.
    #[cfg(feature = "radiosity")]
    pub reflections: Option<&'a wgpu::TextureView>,
}

/// The averaged picture of one size, and its bind groups.
pub struct Picture {
    texture: wgpu::TextureView,
    shading: wgpu::Buffer,
    shade: wgpu::BindGroup,
    look: wgpu::BindGroup,
    measure: wgpu::BindGroup,
    /// Bind group for [`CompositePass::present`].
    pub present: wgpu::BindGroup,
}

impl CompositePass {
    /// Creates the pipelines; `lights` is the layout of the lights' bind group.
    pub fn new(gpu: &Gpu, lights: &wgpu::BindGroupLayout) -> Self {
        let slots = |key| {
            [
                Slot::Uniform,
                Slot::Uniform,
                Slot::TextureLoad,
                Slot::TextureUint,
                Slot::Depth,
                Slot::Read,
                Slot::Read,
                key,
                Slot::Read,
                Slot::TextureLoad,
                Slot::TextureLoad,
                Slot::TextureLoad,
                Slot::Uniform,
                Slot::Texture,
                Slot::Sampler,
                #[cfg(feature = "radiosity")]
                Slot::TextureLoad,
                #[cfg(feature = "radiosity")]
                Slot::TextureLoad,
            ]
        };
        let shade = layout(gpu, "shade", ShaderStages::FRAGMENT, &slots(Slot::Read));
        let look_layout = layout(gpu, "look", ShaderStages::COMPUTE, &slots(Slot::Write));
        let slots = [Slot::Read, Slot::Write, Slot::Read];
        let key_layout = layout(gpu, "key", ShaderStages::COMPUTE, &slots);
        let before_layout = layout(gpu, "before", ShaderStages::FRAGMENT, &[Slot::TextureLoad]);
        let slots = [Slot::Texture, Slot::Sampler, Slot::Uniform];
        let present_layout = layout(gpu, "present", ShaderStages::FRAGMENT, &slots);
        let bilinear = bilinear(gpu);
        let average = wgpu::BlendComponent {
            src_factor: BlendFactor::SrcAlpha,
            dst_factor: BlendFactor::OneMinusSrcAlpha,
            operation: BlendOperation::Add,
        };
        let picture = Draw {
            label: "composite",
            source: shaders::COMPOSITE,
            vertex: "fullscreen",
            targets: &[blended(PICTURE, wgpu::BlendState { color: average, alpha: average })],
            layouts: &[&shade, lights],
            ..Default::default()
        }
        .pipeline(gpu);
        Self {
            look: (compute(gpu, "look", shaders::LOOK, &[&look_layout, lights], &[]), look_layout),
            key: (compute(gpu, "measure", shaders::KEY, &[&key_layout], &[]), key_layout),
            layout: shade,
            picture,
            indirect: OnceCell::new(),
            lights: lights.clone(),
            before_layout,
            present_layout,
            bilinear,
            around: around(gpu),
            present: RefCell::default(),
        }
    }

    /// Creates a picture of this size.
    pub fn target(&self, scope: &Scope, from: &PictureSources<'_>, size: [u32; 2]) -> Picture {
        let texture = target(scope, "picture", PICTURE, size[0], size[1]);
        let texture = texture.create_view(&Default::default());
        let looked = empty_buffer(scope, "looked", BufferUsages::STORAGE, 4 * LOOKED as u64);
        let (unread, tints) = (&from.gbuffer.albedo, from.veil.and_then(|veil| veil.tints.as_ref()));
        let mut resources = [
            from.frame.as_entire_binding(),
            from.shading.as_entire_binding(),
            view(&from.gbuffer.albedo),
            view(&from.gbuffer.surface),
            view(&from.gbuffer.depth),
            from.slots.light.as_entire_binding(),
            from.looks.as_entire_binding(),
            from.key.as_entire_binding(),
            from.slots.by_pixel.as_entire_binding(),
            // Placeholders: not read without blended surfaces.
            view(from.veil.map_or(unread, |veil| &veil.texture)),
            view(tints.map_or(unread, |tints| &tints.through.1)),
            view(tints.map_or(unread, |tints| &tints.shine.1)),
            from.ground.as_entire_binding(),
            view(from.sky.unwrap_or(unread)),
            wgpu::BindingResource::Sampler(&self.around),
            #[cfg(feature = "radiosity")]
            view(from.lightmap.unwrap_or(unread)),
            #[cfg(feature = "radiosity")]
            view(from.reflections.unwrap_or(unread)),
        ];
        let shade = group(scope, "shade", &self.layout, &resources);
        resources[7] = looked.as_entire_binding();
        let measured = [&looked, from.key, from.levels].map(|buffer| buffer.as_entire_binding());
        Picture {
            shade,
            look: group(scope, "look", &self.look.1, &resources),
            measure: group(scope, "key", &self.key.1, &measured),
            present: self.present_group(scope, &texture, from.shading),
            texture,
            shading: from.shading.clone(),
        }
    }

    /// Sets the parameters of the following passes.
    pub fn set_shading(&self, gpu: &Gpu, picture: &Picture, shading: &Shading) {
        gpu.queue.write_buffer(&picture.shading, 0, bytemuck::bytes_of(shading));
    }

    /// Measures the automatic exposure.
    pub fn measure(&self, encoder: &mut wgpu::CommandEncoder, picture: &Picture, lights: &wgpu::BindGroup) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.look.0);
        pass.set_bind_group(0, &picture.look, &[]);
        pass.set_bind_group(1, lights, &[]);
        pass.dispatch_workgroups(LOOKED / WORKGROUP, 1, 1);
        pass.set_pipeline(&self.key.0);
        pass.set_bind_group(0, &picture.measure, &[]);
        pass.dispatch_workgroups(1, 1, 1);
    }

    /// Shades the picture; blends with the earlier average by the share in [`Shading::blend`].
    pub fn shade(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        picture: &Picture,
        lights: &wgpu::BindGroup,
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        self.pass(encoder, &self.picture, &picture.texture, &[&picture.shade, lights], timestamps);
    }

    /// Averages the bounced light alone with the texture `before`, by the share in [`Shading::blend`], and writes
    /// to `out`. Both textures are [`TextureFormat::Rgba32Float`], a format without blending in place.
    pub fn indirect(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        picture: &Picture,
        lights: &wgpu::BindGroup,
        [before, out]: [&wgpu::Texture; 2],
    ) {
        let [before, out] = [before, out].map(|texture| texture.create_view(&Default::default()));
        let before = group(gpu, "indirect before", &self.before_layout, &[view(&before)]);
        let pipeline = self.indirect.get_or_init(|| {
            Draw {
                label: "indirect",
                source: shaders::INDIRECT,
                vertex: "fullscreen",
                targets: &[opaque(TextureFormat::Rgba32Float)],
                layouts: &[&self.layout, &self.lights, &self.before_layout],
                ..Default::default()
            }
            .pipeline(gpu)
        });
        self.pass(encoder, pipeline, &out, &[&picture.shade, lights, &before], None);
    }

    /// Bind group for [`Self::present`]: a picture of linear display values, and the uniform from [`shading`].
    pub fn present_group(
        &self,
        gpu: &Gpu,
        picture: &wgpu::TextureView,
        shading: &wgpu::Buffer,
    ) -> wgpu::BindGroup {
        let sampler = wgpu::BindingResource::Sampler(&self.bilinear);
        group(gpu, "present", &self.present_layout, &[view(picture), sampler, shading.as_entire_binding()])
    }

    /// Encodes a picture to a target of this format.
    pub fn present(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        picture: &wgpu::BindGroup,
        target: &wgpu::TextureView,
        format: TextureFormat,
    ) {
        let pipeline = self.present_pipeline(gpu, format);
        self.pass(encoder, &pipeline, target, &[picture], None);
    }

    fn present_pipeline(&self, gpu: &Gpu, format: TextureFormat) -> wgpu::RenderPipeline {
        let mut made = self.present.borrow_mut();
        if let Some((_, pipeline)) = made.iter().find(|(of, _)| *of == format) {
            return pipeline.clone();
        }
        let pipeline = Draw {
            label: "present",
            source: shaders::PRESENT,
            vertex: "fullscreen",
            targets: &[opaque(format)],
            layouts: &[&self.present_layout],
            ..Default::default()
        }
        .pipeline(gpu);
        made.push((format, pipeline.clone()));
        pipeline
    }

    fn pass(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        pipeline: &wgpu::RenderPipeline,
        target: &wgpu::TextureView,
        groups: &[&wgpu::BindGroup],
        timestamps: Option<wgpu::RenderPassTimestampWrites<'_>>,
    ) {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[attachment(target, false)],
            timestamp_writes: timestamps,
            ..Default::default()
        });
        pass.set_pipeline(pipeline);
        for (slot, group) in (0..).zip(groups) {
            pass.set_bind_group(slot, *group, &[]);
        }
        pass.draw(0..3, 0..1);
    }
}
