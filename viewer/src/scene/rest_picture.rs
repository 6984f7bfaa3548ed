//! The picture of where the file has what deforms: rest_places.wgsl writes it, rest_pixel.wgsl reads it.

use crate::gpu::bindings::target;
use crate::gpu::scope::Scope;
use wgpu::TextureFormat;

/// Position at rest, as bits of floats, and packed normal; zero where nothing deforms.
pub const REST: TextureFormat = TextureFormat::Rgba32Uint;

/// A picture of this size, in pixels.
pub fn rest_picture(scope: &Scope, size: [u32; 2]) -> wgpu::TextureView {
    target(scope, "places at rest", REST, size[0], size[1]).create_view(&Default::default())
}
