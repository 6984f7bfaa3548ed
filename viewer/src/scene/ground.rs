//! The ground under an object: `Ground` of backdrop.wgsl.

use crate::gpu::bindings::buffer;
use crate::gpu::scope::Scope;
use rebounce_shared::rbn::shown::GROUND;
use wgpu::BufferUsages;

/// The uniform of an object's ground; zeros without a ground.
pub fn uniform(scope: &Scope, ground: &[u8]) -> wgpu::Buffer {
    let none = [0; GROUND];
    let bytes = if ground.is_empty() { &none } else { ground };
    buffer(scope, "ground", BufferUsages::UNIFORM, bytes)
}
