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
