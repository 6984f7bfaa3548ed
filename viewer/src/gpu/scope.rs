//! Ownership of GPU resources.
//!
//! In a browser, an unreferenced buffer or texture keeps its memory until garbage collection, and the device,
//! shared by viewers, outlives each viewer. Therefore every resource is created through a scope and destroyed with
//! the scope.

use super::device::Gpu;
use std::cell::RefCell;
use std::ops::Deref;

/// Owns buffers, textures and queries of a device, and destroys them on drop. Work submitted before the drop still
/// completes; later work must not use these resources.
pub struct Scope {
    gpu: Gpu,
    held: RefCell<Vec<Held>>,
}

enum Held {
    Buffer(wgpu::Buffer),
    Texture(wgpu::Texture),
    Queries(wgpu::QuerySet),
}

impl Scope {
    /// A scope without resources.
    pub fn new(gpu: &Gpu) -> Self {
        Self { gpu: gpu.clone(), held: RefCell::default() }
    }

    /// Creates a buffer.
    pub fn buffer(&self, descriptor: &wgpu::BufferDescriptor<'_>) -> wgpu::Buffer {
        let buffer = self.device.create_buffer(descriptor);
        self.held.borrow_mut().push(Held::Buffer(buffer.clone()));
        buffer
    }

    /// Creates a texture.
    pub fn texture(&self, descriptor: &wgpu::TextureDescriptor<'_>) -> wgpu::Texture {
        let texture = self.device.create_texture(descriptor);
        self.held.borrow_mut().push(Held::Texture(texture.clone()));
        texture
    }

    /// Creates a query set.
    pub fn queries(&self, descriptor: &wgpu::QuerySetDescriptor<'_>) -> wgpu::QuerySet {
        let queries = self.device.create_query_set(descriptor);
        self.held.borrow_mut().push(Held::Queries(queries.clone()));
        queries
    }

    /// Bytes of the scope's buffers and textures.
    pub fn bytes(&self) -> u64 {
        let size = |held: &Held| match held {
            Held::Buffer(buffer) => buffer.size(),
            Held::Texture(texture) => texture_bytes(texture),
            Held::Queries(_) => 0,
        };
        self.held.borrow().iter().map(size).sum()
    }
}

impl Deref for Scope {
    type Target = Gpu;

    fn deref(&self) -> &Gpu {
        &self.gpu
    }
}

impl Drop for Scope {
    fn drop(&mut self) {
        for held in self.held.get_mut() {
            match held {
                Held::Buffer(buffer) => buffer.destroy(),
                Held::Texture(texture) => texture.destroy(),
                Held::Queries(queries) => queries.destroy(),
            }
        }
    }
}

/// Bytes of a texture with its mip levels, by the format's bytes a texel; 4 for formats without a fixed size.
pub fn texture_bytes(texture: &wgpu::Texture) -> u64 {
    let size = texture.size();
    let texel = texture.format().block_copy_size(Some(wgpu::TextureAspect::All)).unwrap_or(4) as u64;
    (0..texture.mip_level_count())
        .map(|level| {
            let side = |x: u32| (x >> level).max(1) as u64;
            side(size.width) * side(size.height) * size.depth_or_array_layers as u64 * texel
        })
        .sum()
}
