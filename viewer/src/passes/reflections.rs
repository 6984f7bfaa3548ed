//! Reflections of glossy surfaces in a picture of their own, which the composite pass reads.

use super::gbuffer::GBuffer;
use crate::gpu::Gpu;
use crate::gpu::bindings::{
    Draw, Slot, around, attachment, empty_buffer, group, layout, opaque, target, view,
};
use crate::gpu::scope::Scope;
use crate::scene::GpuScene;
use crate::scene::gloss::GpuGloss;
use crate::scene::sky::{MOST_SKIES, ReflectedTexture};
use crate::shaders;
use bytemuck::{Pod, Zeroable};
use rebounce_shared::harmonics::{COUNT, Coefficients};
use std::cell::OnceCell;
use wgpu::{BufferUsages, ShaderStages, TextureFormat};

/// Format of the picture: light may be very bright.
const LIGHT: TextureFormat = TextureFormat::Rgba32Float;

/// The G-buffer holds what textures say.
const DETAILED: u32 = 1;
/// Metals reflect their base colour at every angle, and nothing else shines.
const CONDUCTORS: u32 = 2;
/// Matrices hold light that did not bounce.
const HAS_DIRECT: u32 = 4;

/// `Reflecting` in reflections.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Reflecting {
    sky: [[f32; 4]; MOST_SKIES],
    smooth: [[f32; 4]; COUNT],
    skies: u32,
    flags: u32,
    metals: f32,
    others: f32,
    maps: u32,
    map_side: f32,
    map_unit: f32,
    map_roughness: f32,
}

/// Distant light as surfaces reflect it.
pub struct DistantLight<'a> {
    /// By sky: factor of the texture, RGB, and rotation in radians.
    pub skies: &'a [[f32; 4]],
    /// Coefficients of their radiance.
    pub coefficients: &'a Coefficients,
    /// Metals are GGX conductors of constant reflectance, and nothing else shines: as SHOT.json's `gloss` has it.
    pub conductors: bool,
    /// Factor of radiance in cube maps.
    pub map_unit: f32,
}

/// Samplers of the pass.
struct Samplers {
    /// Trilinear.
    around: wgpu::Sampler,
    /// Of distances.
    nearest: wgpu::Sampler,
}

/// The pipeline; made on first use.
#[derive(Default)]
pub struct ReflectionsPass {
    made: OnceCell<(wgpu::BindGroupLayout, wgpu::RenderPipeline, Samplers)>,
}

/// The picture of one size.
pub struct ReflectionsTarget {
    /// RGB radiance; alpha as in reflections.wgsl.
    pub picture: wgpu::TextureView,
    uniform: wgpu::Buffer,
    bound: wgpu::BindGroup,
}

/// Inputs of a [`ReflectionsTarget`].
pub struct ReflectionsSources<'a> {
    /// The camera's uniform.
    pub frame: &'a wgpu::Buffer,
    /// Opaque surfaces.
    pub gbuffer: &'a GBuffer,
    /// The slots' layout, rows, and numbers by pixel.
    pub slots: [&'a wgpu::Buffer; 3],
    /// The scene.
    pub scene: &'a GpuScene,
    /// Its glossy transfer.
    pub gloss: &'a GpuGloss,
    /// The environment.
    pub sky: Option<&'a ReflectedTexture>,
}

impl ReflectionsPass {
    fn made(&self, gpu: &Gpu) -> &(wgpu::BindGroupLayout, wgpu::RenderPipeline, Samplers) {
        self.made.get_or_init(|| {
            let slots = [
                Slot::Uniform,
                Slot::Uniform,
                Slot::TextureLoad,
                Slot::TextureUint,
                Slot::Depth,
                Slot::Read,
                Slot::Read,
                Slot::Read,
                Slot::Read,
                Slot::Read,
                Slot::Uniform,
                Slot::Texture,
                Slot::Sampler,
                Slot::Read,
                Slot::UnfilteredCubeArray,
                Slot::Unfiltered,
                Slot::CubeArray,
                Slot::Sampler,
            ];
            let layout = layout(gpu, "reflections", ShaderStages::FRAGMENT, &slots);
            let pipeline = Draw {
                label: "reflections",
                source: shaders::REFLECTIONS,
                vertex: "fullscreen",
                targets: &[opaque(LIGHT)],
                layouts: &[&layout],
                ..Default::default()
            }
            .pipeline(gpu);
            let nearest = gpu.device.create_sampler(&Default::default());
            (layout, pipeline, Samplers { around: around(gpu), nearest })
        })
    }

    /// Creates a picture of this size.
    pub fn target(&self, scope: &Scope, from: &ReflectionsSources<'_>, size: [u32; 2]) -> ReflectionsTarget {
        let (layout, _, samplers) = self.made(scope);
        let picture = target(scope, "reflections", LIGHT, size[0], size[1]);
        let usage = BufferUsages::UNIFORM | BufferUsages::STORAGE | BufferUsages::COPY_DST;
        let uniform = empty_buffer(scope, "reflecting", usage, size_of::<Reflecting>() as u64);
        let [slots, rows, by_pixel] = from.slots;
        let maps = from.scene.cube_maps.as_ref().map(|maps| &maps.textures);
        // Placeholders, not read without maps.
        let no_maps = maps.is_none().then(|| no_maps(scope));
        let [distances, radiance] = match (maps, &no_maps) {
            (Some(maps), _) => [&maps.distances, &maps.radiance],
            (None, none) => [none.as_ref().unwrap_or(&from.gbuffer.albedo); 2],
        };
        let resources = [
            from.frame.as_entire_binding(),
            slots.as_entire_binding(),
            view(&from.gbuffer.albedo),
            view(&from.gbuffer.surface),
            view(&from.gbuffer.depth),
            rows.as_entire_binding(),
            by_pixel.as_entire_binding(),
            from.gloss.places.as_entire_binding(),
            from.gloss.arriving.as_entire_binding(),
            from.scene.materials.looks.as_entire_binding(),
            uniform.as_entire_binding(),
            // A placeholder: not read without skies.
            view(from.sky.map_or(&from.gbuffer.albedo, |sky| &sky.view)),
            wgpu::BindingResource::Sampler(&samplers.around),
            maps.map_or(&uniform, |maps| &maps.places).as_entire_binding(),
            view(distances),
            wgpu::BindingResource::Sampler(&samplers.nearest),
            view(radiance),
            wgpu::BindingResource::Sampler(&samplers.around),
        ];
        ReflectionsTarget {
            bound: group(scope, "reflections", layout, &resources),
            picture: picture.create_view(&Default::default()),
            uniform,
        }
    }

    /// Draws the reflections, after the functions of the pixels are found and the light has arrived at the points.
    pub fn draw(
        &self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        target: &ReflectionsTarget,
        scene: &GpuScene,
        gloss: &GpuGloss,
        light: &DistantLight<'_>,
    ) {
        let flag = |on: bool, bit: u32| if on { bit } else { 0 };
        let [metals, others] = gloss.layout.roughness;
        let reflecting = Reflecting {
            sky: std::array::from_fn(|i| light.skies.get(i).copied().unwrap_or_default()),
            smooth: light.coefficients.map(|c| c.extend(0.0).to_array()),
            skies: light.skies.len().min(MOST_SKIES) as u32,
            flags: flag(scene.materials.detailed, DETAILED)
                | flag(light.conductors, CONDUCTORS)
                | flag(gloss.layout.has_direct, HAS_DIRECT),
            metals,
            others,
            maps: scene.cube_maps.as_ref().map_or(0, |maps| maps.count),
            map_side: scene.cube_maps.as_ref().map_or(1.0, |maps| maps.side as f32),
            map_unit: light.map_unit,
            map_roughness: scene.cube_maps.as_ref().map_or(0.0, |maps| maps.least_roughness),
        };
        gpu.queue.write_buffer(&target.uniform, 0, bytemuck::bytes_of(&reflecting));
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("reflections"),
            color_attachments: &[attachment(&target.picture, true)],
            ..Default::default()
        });
        pass.set_pipeline(&self.made(gpu).1);
        pass.set_bind_group(0, &target.bound, &[]);
        pass.draw(0..3, 0..1);
    }
}

/// A cube of a texel a face.
fn no_maps(scope: &Scope) -> wgpu::TextureView {
    let texture = scope.texture(&wgpu::TextureDescriptor {
        label: Some("no cube maps"),
        size: wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 6 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::CubeArray),
        ..Default::default()
    })
}
