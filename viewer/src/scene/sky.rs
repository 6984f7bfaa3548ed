//! An environment on the GPU: the picture behind a scene, with mip levels; and on the CPU, prepared for lighting.

use crate::gpu::Gpu;
use crate::gpu::scope::Scope;
use rebounce_shared::colour::pack_rgb9e5;
use rebounce_shared::environment::PackedEnvironment;
#[cfg(feature = "radiosity")]
use rebounce_shared::environment::{Environment, packed};
use rebounce_shared::glam::Vec3;
use rebounce_shared::lighting::PreparedEnvironment;
#[cfg(feature = "radiosity")]
use std::cell::OnceCell;
use std::sync::Arc;
use wgpu::{Extent3d, TextureUsages};

/// Maximum width of the picture that bins and sun are computed from, pixels: a third of a degree.
const LIGHTING_WIDTH: u32 = 1024;
/// The most blurred background has the mip level of about this width, texels.
const BLURRED_WIDTH: u32 = 8;

/// Maximum number of environment lights seen behind a scene, and reflected.
pub const MOST_SKIES: usize = 4;

/// An environment.
pub struct Sky {
    /// Equirectangular radiance divided by [`Sky::scale`], all mip levels.
    pub view: wgpu::TextureView,
    /// Radiance of a texel of 1.
    pub scale: f32,
    /// Bins and sun.
    pub prepared: PreparedEnvironment,
    width: u32,
    /// What surfaces reflect of it; made for the first scene with glossy transfer.
    #[cfg(feature = "radiosity")]
    reflected: OnceCell<ReflectedTexture>,
    own: Scope,
}

/// An environment without its sun, all levels blurred but the finest
/// ([`EnvironmentMips`](rebounce_shared::environment::mips::EnvironmentMips)).
#[cfg(feature = "radiosity")]
pub struct ReflectedTexture {
    /// Radiance divided by the scale.
    pub view: wgpu::TextureView,
    /// Radiance of a texel of 1.
    pub scale: f32,
}

#[cfg(feature = "radiosity")]
impl Sky {
    /// What surfaces reflect of the environment.
    pub fn reflected(&self) -> &ReflectedTexture {
        self.reflected.get_or_init(|| {
            let levels = &self.prepared.reflection().mips().levels;
            let scale = packed::scale(levels.iter().flat_map(|level| &level.pixels));
            let size = |level: &Environment| Extent3d {
                width: level.width,
                height: level.height,
                depth_or_array_layers: 1,
            };
            let texture = self.own.texture(&wgpu::TextureDescriptor {
                label: Some("reflected sky"),
                size: levels.first().map(size).unwrap_or_default(),
                mip_level_count: levels.len() as u32,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgb9e5Ufloat,
                usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
                view_formats: &[],
            });
            for (mip_level, level) in (0..).zip(levels) {
                let texels: Vec<u32> = level.pixels.iter().map(|pixel| pack_rgb9e5(*pixel / scale)).collect();
                self.own.queue.write_texture(
                    wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() },
                    bytemuck::cast_slice(&texels),
                    wgpu::TexelCopyBufferLayout {
                        bytes_per_row: Some(4 * level.width),
                        ..Default::default()
                    },
                    size(level),
                );
            }
            ReflectedTexture { view: texture.create_view(&Default::default()), scale }
        })
    }
}

impl Sky {
    /// Uploads a picture, of any size that the device's textures may have.
    pub fn new(gpu: &Gpu, picture: PackedEnvironment) -> Self {
        let own = Scope::new(gpu);
        let (width, height, scale) = (picture.width, picture.height, picture.scale);
        let texture = own.texture(&wgpu::TextureDescriptor {
            label: Some("sky"),
            size: Extent3d { width, height, depth_or_array_layers: 1 },
            mip_level_count: width.max(height).ilog2() + 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgb9e5Ufloat,
            usage: TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST,
            view_formats: &[],
        });
        let (mut level, mut lighting) = (picture, None);
        for mip_level in 0..texture.mip_level_count() {
            if mip_level > 0 {
                level = level.halved();
            }
            if level.width <= LIGHTING_WIDTH {
                lighting.get_or_insert_with(|| level.unpack());
            }
            gpu.queue.write_texture(
                wgpu::TexelCopyTextureInfo { mip_level, ..texture.as_image_copy() },
                bytemuck::cast_slice(&level.pixels),
                wgpu::TexelCopyBufferLayout { bytes_per_row: Some(4 * level.width), ..Default::default() },
                Extent3d { width: level.width, height: level.height, depth_or_array_layers: 1 },
            );
        }
        let lighting = lighting.unwrap_or_else(|| level.unpack());
        let view = texture.create_view(&Default::default());
        Self {
            view,
            scale,
            prepared: PreparedEnvironment::new(Arc::new(lighting)),
            width,
            #[cfg(feature = "radiosity")]
            reflected: OnceCell::new(),
            own,
        }
    }

    /// Uploads the environment of a file, packed, or an even white for a file without.
    pub fn of_file(gpu: &Gpu, packed: &[u8]) -> Self {
        let white = |_| PackedEnvironment {
            width: 2,
            height: 1,
            scale: 1.0,
            pixels: vec![pack_rgb9e5(Vec3::ONE); 2],
        };
        Self::new(gpu, PackedEnvironment::from_bytes(packed).unwrap_or_else(white))
    }

    /// Mip level of a background with this blur, 0 to 1.
    pub fn level(&self, blur: f32) -> f32 {
        blur * (self.width as f32 / BLURRED_WIDTH as f32).max(1.0).log2()
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.own.bytes()
    }
}
