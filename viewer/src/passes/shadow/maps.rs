//! The textures of shadow maps.

use crate::gpu::Gpu;
use crate::gpu::scope::Scope;
use wgpu::TextureFormat;

/// Colours behind glass; alpha is the depth of the nearest glass.
pub const TINTS: TextureFormat = TextureFormat::Rgba16Float;

/// A depth texture and a view of each layer.
pub struct Maps {
    /// Owns the textures.
    pub own: Scope,
    /// Depths.
    pub texture: wgpu::Texture,
    /// A view of each layer.
    pub layers: Vec<wgpu::TextureView>,
    /// Colours behind glass, at half the size; one texel and no view without glass.
    pub tint: wgpu::Texture,
    /// A view of each layer of `tint`.
    pub tints: Vec<wgpu::TextureView>,
}

impl Maps {
    /// Square maps of this width in texels, with or without colours behind `glass`.
    pub fn new(gpu: &Gpu, size: u32, layers: u32, glass: bool) -> Self {
        let own = Scope::new(gpu);
        let array = |label, format, size: u32, layers| {
            own.texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d { width: size, height: size, depth_or_array_layers: layers },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
        };
        let texture = array("shadow maps", TextureFormat::Depth32Float, size, layers);
        let tint = match glass {
            true => array("tint maps", TINTS, (size / 2).max(2), layers),
            false => array("no tint maps", TINTS, 1, 1),
        };
        let views = |texture: &wgpu::Texture, layers| -> Vec<wgpu::TextureView> {
            let layer = |base_array_layer| {
                texture.create_view(&wgpu::TextureViewDescriptor {
                    dimension: Some(wgpu::TextureViewDimension::D2),
                    base_array_layer,
                    array_layer_count: Some(1),
                    ..Default::default()
                })
            };
            (0..layers).map(layer).collect()
        };
        let tints = views(&tint, if glass { layers } else { 0 });
        Self { layers: views(&texture, layers), texture, tints, tint, own }
    }
}
