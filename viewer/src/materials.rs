//! Materials: one bind group each (WebGPU has no arrays of textures to index).

use crate::bindings::{Slot, buffer, group, layout, view};
use crate::error::ViewerError;
use crate::gpu::Gpu;
use crate::textures::{self, Mips};
use bytemuck::{Pod, Zeroable};
use rebounce_shared::rbn::Scene;
use rebounce_shared::rbn::meta::{Alpha, Material, Texture, Wrap};
use std::num::NonZeroU64;
use wgpu::{BufferUsages, ShaderStages};

/// Distance of materials in their uniform buffer, bytes.
const STRIDE: u64 = 256;

/// `Material` in material.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Record {
    base_color: [f32; 4],
    alpha_mode: u32,
    cutoff: f32,
    double_sided: u32,
    index: u32,
}

impl Record {
    fn new(index: usize, material: &Material) -> Self {
        let (alpha_mode, cutoff) = match material.alpha {
            Alpha::Opaque => (0, 0.0),
            Alpha::Mask { cutoff } => (1, cutoff),
            Alpha::Blend => (2, 0.0),
        };
        Self {
            base_color: material.base_color,
            alpha_mode,
            cutoff,
            double_sided: material.double_sided as u32,
            // The G-buffer keeps 16 bits.
            index: index.min(0xffff) as u32,
        }
    }
}

/// The layout of a material's bind group.
pub fn material_layout(gpu: &Gpu) -> wgpu::BindGroupLayout {
    layout(
        gpu,
        "material",
        ShaderStages::FRAGMENT,
        &[Slot::Uniform, Slot::Texture, Slot::Sampler, Slot::Sampler, Slot::Sampler],
    )
}

/// All materials of a scene.
pub struct Materials {
    /// One bind group per material.
    pub groups: Vec<wgpu::BindGroup>,
    /// Radiance that each sends out: RGB and one unused, 16 bytes a material.
    pub emission: wgpu::Buffer,
    /// Bytes of the textures on the GPU.
    pub bytes: u64,
}

impl Materials {
    /// Decodes and uploads the textures and makes the bind groups.
    ///
    /// # Errors
    /// [`ViewerError::Texture`] for one that cannot be decoded.
    pub async fn new(gpu: &Gpu, layout: &wgpu::BindGroupLayout, scene: &Scene) -> Result<Self, ViewerError> {
        let mips = Mips::new(gpu);
        let (textures, bytes) = textures::load(gpu, &mips, scene).await?;
        let white = textures::white(gpu);
        let mut records = vec![0u8; STRIDE as usize * scene.meta.materials.len()];
        for (i, material) in scene.meta.materials.iter().enumerate() {
            let record = Record::new(i, material);
            let at = i * STRIDE as usize;
            records[at..at + size_of::<Record>()].copy_from_slice(bytemuck::bytes_of(&record));
        }
        let uniforms = buffer(gpu, "materials", BufferUsages::UNIFORM, &records);
        let emission: Vec<[f32; 4]> = scene
            .meta
            .materials
            .iter()
            .take(0x10000)
            .map(|m| [m.emission[0], m.emission[1], m.emission[2], 0.0])
            .collect();
        let emission = buffer(gpu, "emission", BufferUsages::STORAGE, bytemuck::cast_slice(&emission));
        let plain = Texture { linear_filter: true, ..Default::default() };
        let groups = scene
            .meta
            .materials
            .iter()
            .enumerate()
            .map(|(i, material)| {
                let texture = material.base_color_texture.map(|t| t as usize);
                let info = texture.map_or(&plain, |t| &scene.meta.textures[t]);
                let texture = texture.map_or(&white, |t| &textures[t]);
                let uniform = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer: &uniforms,
                    offset: i as u64 * STRIDE,
                    size: NonZeroU64::new(size_of::<Record>() as u64),
                });
                let resources = [
                    uniform,
                    view(texture),
                    wgpu::BindingResource::Sampler(&sampler(gpu, info, info.linear_filter, 8)),
                    wgpu::BindingResource::Sampler(&sampler(gpu, info, false, 1)),
                    wgpu::BindingResource::Sampler(&sampler(gpu, info, info.linear_filter, 1)),
                ];
                group(gpu, "material", layout, &resources)
            })
            .collect();
        Ok(Self { groups, emission, bytes })
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
