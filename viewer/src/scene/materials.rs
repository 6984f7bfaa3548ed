//! Materials: one bind group per material (WebGPU has no arrays of textures to index).

use super::blended_fit;
use super::textures::{self, Mips};
use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::gpu::bindings::{Slot, buffer, group, layout, view};
use crate::gpu::scope::Scope;
use bytemuck::{Pod, Zeroable};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_shared::rbn::meta::{Alpha, Material, Texture, Wrap};
use std::num::NonZeroU64;
use wgpu::{BufferUsages, ShaderStages};

/// Stride of materials in the uniform buffer, bytes.
const STRIDE: u64 = 256;
/// Maximum anisotropy: texels averaged for a pixel along the slant of a surface.
const ANISOTROPY: u16 = 8;

/// `Material` in material.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Record {
    base_color: [f32; 4],
    alpha_mode: u32,
    cutoff: f32,
    double_sided: u32,
    index: u32,
    metallic: f32,
    roughness: f32,
    normal_scale: f32,
    details: u32,
    wide: u32,
    glass: u32,
    transmission: f32,
    scattered: f32,
    uv_from_vertex: [[f32; 4]; 8],
    transmission_tint: [f32; 4],
    scattered_color: [f32; 4],
}

/// `MaterialRecord` in brdf.wgsl, or in brdf_coated.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct MaterialRecord {
    emission: [f32; 3],
    specular: f32,
    metallic: f32,
    roughness: f32,
    unlit: f32,
    #[cfg(not(feature = "radiosity"))]
    pad: f32,
    #[cfg(feature = "radiosity")]
    clearcoat: f32,
    #[cfg(feature = "radiosity")]
    head_on: [f32; 3],
    #[cfg(feature = "radiosity")]
    clearcoat_roughness: f32,
}

impl Record {
    fn new(index: usize, material: &Material, wide: bool, blended: bool) -> Self {
        let (alpha_mode, cutoff) = match material.alpha {
            Alpha::Mask { cutoff } => (1, cutoff),
            Alpha::Blend if blended => (2, 0.0),
            Alpha::Opaque | Alpha::Blend => (0, 0.0),
        };
        Self {
            base_color: material.base_color,
            alpha_mode,
            cutoff,
            double_sided: material.double_sided as u32,
            // The G-buffer stores 16 bits, enough for every file (rbn::MAX_MATERIALS).
            index: index as u32,
            metallic: material.metallic,
            roughness: material.roughness,
            normal_scale: material.normal_scale,
            details: (0..).zip(material.details()).map(|(i, d)| (d.is_some() as u32) << i).sum(),
            wide: wide as u32,
            glass: material.is_glass() as u32,
            transmission: material.extras.transmission,
            scattered: material.extras.scattered,
            transmission_tint: Vec3::from(material.extras.transmission_tint).extend(0.0).to_array(),
            scattered_color: Vec3::from(material.extras.scattered_color).extend(0.0).to_array(),
            uv_from_vertex: std::array::from_fn(|row| {
                let detail = material.details()[row / 2];
                detail.map_or([0.0; 4], |d| {
                    let [a, b, c] = d.uv_from_vertex[row % 2];
                    [a, b, c, 0.0]
                })
            }),
        }
    }
}

/// The layout of a material's bind group.
pub fn material_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    let mut slots = vec![Slot::Uniform, Slot::Texture, Slot::Sampler, Slot::Sampler, Slot::Sampler];
    slots.extend([Slot::Texture, Slot::Sampler].repeat(4));
    layout(gpu, "material", ShaderStages::FRAGMENT, &slots)
}

/// All materials of a scene.
pub struct Materials {
    /// One bind group per material.
    pub groups: Vec<wgpu::BindGroup>,
    /// `MaterialRecord` of the shaders for every material.
    pub looks: wgpu::Buffer,
    records: Vec<MaterialRecord>,
    /// Group of emissive surfaces of each material.
    groups_of: Vec<Option<u32>>,
    /// Whether a material has textures other than base colour and transmission.
    pub detailed: bool,
    /// Whether a material is unlit.
    pub unlit: bool,
    own: Scope,
}

impl Materials {
    /// Decodes and uploads the textures and creates the bind groups.
    ///
    /// # Errors
    /// [`ViewerError::Texture`] for a texture that cannot be decoded.
    pub async fn new(
        gpu: &Gpu,
        layout: &wgpu::BindGroupLayout,
        mips: &Mips,
        scene: &BakedScene,
    ) -> Result<Self, ViewerError> {
        let own = Scope::new(gpu);
        let textures = textures::load(&own, mips, scene).await?;
        Ok(gpu.watch(|| Self::with(own, layout, scene, &textures)))
    }

    fn with(
        own: Scope,
        layout: &wgpu::BindGroupLayout,
        scene: &BakedScene,
        textures: &[wgpu::TextureView],
    ) -> Self {
        let white = textures::white(&own);
        let materials = &scene.meta.materials;
        let detailed = materials.iter().any(|m| m.details()[..3].iter().any(Option::is_some));
        let mut records = vec![0u8; STRIDE as usize * scene.meta.materials.len()];
        for (i, material) in scene.meta.materials.iter().enumerate() {
            let record = Record::new(i, material, detailed, blended_fit::is_blended(&scene.meta, material));
            let at = i * STRIDE as usize;
            records[at..at + size_of::<Record>()].copy_from_slice(bytemuck::bytes_of(&record));
        }
        let uniforms = buffer(&own, "materials", BufferUsages::UNIFORM, &records);
        let look = |m: &Material| MaterialRecord {
            emission: m.emission,
            specular: m.specular,
            metallic: m.metallic,
            roughness: m.roughness,
            unlit: m.extras.unlit as u32 as f32,
            #[cfg(not(feature = "radiosity"))]
            pad: 0.0,
            #[cfg(feature = "radiosity")]
            clearcoat: m.specular_extras.clearcoat,
            #[cfg(feature = "radiosity")]
            head_on: m.specular_extras.head_on(m.specular).to_array(),
            #[cfg(feature = "radiosity")]
            clearcoat_roughness: m.specular_extras.clearcoat_roughness,
        };
        let own_looks: Vec<MaterialRecord> = materials.iter().map(look).collect();
        let looks = buffer(&own, "looks", BufferUsages::STORAGE, bytemuck::cast_slice(&own_looks));
        let plain = Texture { linear_filter: true, ..Default::default() };
        let texture = |index: Option<u32>| match index {
            Some(t) => (&scene.meta.textures[t as usize], &textures[t as usize]),
            None => (&plain, &white),
        };
        let bind = |(i, material): (usize, &Material)| {
            let (info, base) = texture(material.base_color_texture);
            let uniform = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                buffer: &uniforms,
                offset: i as u64 * STRIDE,
                size: NonZeroU64::new(size_of::<Record>() as u64),
            });
            let samplers = [
                sampler(&own, info, info.linear_filter, ANISOTROPY),
                sampler(&own, info, false, 1),
                sampler(&own, info, info.linear_filter, 1),
            ];
            let details = material.details().map(|detail| {
                let (info, texture) = texture(detail.map(|d| d.texture));
                (texture, sampler(&own, info, info.linear_filter, ANISOTROPY))
            });
            let mut resources = vec![uniform, view(base)];
            resources.extend(samplers.iter().map(wgpu::BindingResource::Sampler));
            for (texture, sampler) in &details {
                resources.extend([view(texture), wgpu::BindingResource::Sampler(sampler)]);
            }
            group(&own, "material", layout, &resources)
        };
        let groups = materials.iter().enumerate().map(bind).collect();
        let unlit = materials.iter().any(|m| m.extras.unlit);
        let groups_of = scene.sources.group_of_materials();
        Self { groups, looks, records: own_looks, groups_of, detailed, unlit, own }
    }

    /// Sets the factor of the emission of each group of emissive surfaces.
    pub fn set_emission(&self, gpu: &Gpu, factors: &[Vec3]) {
        let mut looks = self.records.clone();
        for (look, group) in looks.iter_mut().zip(&self.groups_of) {
            if let Some(factor) = group.and_then(|group| factors.get(group as usize)) {
                look.emission = (Vec3::from(look.emission) * *factor).to_array();
            }
        }
        gpu.queue.write_buffer(&self.looks, 0, bytemuck::cast_slice(&looks));
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}

fn sampler(gpu: &Gpu, texture: &Texture, linear: bool, anisotropy: u16) -> wgpu::Sampler {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::MirroredRepeat => wgpu::AddressMode::MirrorRepeat,
        Wrap::ClampToEdge => wgpu::AddressMode::ClampToEdge,
    };
    let filter = if linear { wgpu::FilterMode::Linear } else { wgpu::FilterMode::Nearest };
    gpu.device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: wrap(texture.wrap_u),
        address_mode_v: wrap(texture.wrap_v),
        mag_filter: filter,
        min_filter: filter,
        mipmap_filter: if linear { wgpu::MipmapFilterMode::Linear } else { wgpu::MipmapFilterMode::Nearest },
        anisotropy_clamp: if linear { anisotropy } else { 1 },
        ..Default::default()
    })
}
