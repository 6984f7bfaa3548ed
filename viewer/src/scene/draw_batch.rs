//! Draw batches: arguments of a draw call, and the layout of the vertex buffers.

use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::bulk::Instance;
use std::ops::Range;

/// Position, normal and texture coordinates of [`rebounce_shared::rbn::bulk::Vertex`], and the rows of an [`Instance`].
pub const VERTEX_BUFFERS: [Option<wgpu::VertexBufferLayout<'static>>; 2] = [
    Some(wgpu::VertexBufferLayout {
        array_stride: 24,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm16x2, 2 => Float32x2],
    }),
    Some(wgpu::VertexBufferLayout {
        array_stride: 48,
        step_mode: wgpu::VertexStepMode::Instance,
        attributes: &wgpu::vertex_attr_array![3 => Float32x4, 4 => Float32x4, 5 => Float32x4],
    }),
];

/// Triangles of one material, drawn by one call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawBatch {
    /// Index of the material.
    pub material: u32,
    /// Range of the index buffer.
    pub indices: Range<u32>,
    /// Range of the instance buffer; the buffer's first entry is the identity, for meshes without copies.
    pub instances: Range<u32>,
    /// Whether the material cuts holes by alpha; in shadows also if the material is blended.
    pub cut: bool,
    /// Whether the material is blended.
    pub blended: bool,
    /// Whether the material transmits coloured light: excluded from the depth of shadow maps.
    pub glass: bool,
    /// Whether the material is one-sided: back faces are invisible to the camera. Shadows ignore the flag.
    pub one_sided: bool,
}

impl DrawBatch {
    /// Draws the batch, after [`Upload::bind`](crate::scene::upload::Upload::bind).
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.draw_indexed(self.indices.clone(), 0, self.instances.clone());
    }
}

/// Transforms of a batch's instances.
pub fn instances<'a>(scene: &'a BakedScene, run: &DrawBatch) -> &'a [Instance] {
    match run.instances.start {
        0 => &[Instance::IDENTITY],
        first => &scene.instances[first as usize - 1..run.instances.end as usize - 1],
    }
}
