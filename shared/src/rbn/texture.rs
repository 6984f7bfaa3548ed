//! References of materials to textures.

use bincode::{Decode, Encode};

/// Reference to a detail texture (not the base colour).
#[derive(Clone, Copy, Debug, Default, PartialEq, Encode, Decode)]
pub struct DetailTexture {
    /// Index of the texture.
    pub texture: u32,
    /// Matrix from the vertex's (u, v, 1) to texture coordinates, row by row.
    pub uv_from_vertex: [[f32; 3]; 2],
}
