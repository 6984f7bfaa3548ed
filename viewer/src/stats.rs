//! What the viewer tells about itself.

use crate::timing::Milliseconds;

/// Counts, bytes and times.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Stats {
    /// Name of the graphics adapter.
    pub adapter: String,
    /// The scene's name.
    pub scene: String,
    /// Milliseconds per pass when it last ran; all absent where the device cannot time passes.
    pub milliseconds: Milliseconds,
    /// Pictures drawn so far.
    pub frames: u64,
    /// Times that light was computed anew.
    pub relights: u64,
    /// Shadow-map layers drawn so far.
    pub shadow_layers: u64,
    /// Width of a shadow map, texels.
    pub shadow_size: u32,
    /// Triangles of the scene.
    pub triangles: usize,
    /// Basis functions per level, coarsest first.
    pub functions: Vec<u32>,
    /// Transport links.
    pub links: usize,
    /// Lights.
    pub lights: usize,
    /// Bytes on the GPU.
    pub bytes: Bytes,
}

/// How the bounced light of a picture was looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Counts {
    /// Pixels of the picture.
    pub pixels: u64,
    /// Pixels that looked functions up; the others are interpolated.
    pub rows: u64,
    /// Functions whose sphere was tested.
    pub looked_at: u64,
    /// Kernels evaluated.
    pub evaluated: u64,
}

impl Counts {
    /// From the size of the picture and what [`Renderer::read_counts`](crate::renderer::Renderer::read_counts) reads.
    pub fn new([width, height]: [u32; 2], counts: &[u8]) -> Self {
        let count = |i: usize| bytemuck::pod_read_unaligned::<u32>(&counts[4 * i..4 * i + 4]) as u64;
        let blocks = width.div_ceil(2) as u64 * height.div_ceil(2) as u64;
        Self {
            pixels: width as u64 * height as u64,
            rows: blocks + count(0),
            looked_at: count(1),
            evaluated: count(2),
        }
    }
}

/// Bytes on the GPU.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
#[serde(rename_all = "camelCase")]
pub struct Bytes {
    /// The file's bulk sections.
    pub scene: u64,
    /// Textures.
    pub textures: u64,
    /// Buffers of the relighting.
    pub relight: u64,
    /// Shadow maps.
    pub shadows: u64,
    /// Targets of the picture's size.
    pub picture: u64,
}
