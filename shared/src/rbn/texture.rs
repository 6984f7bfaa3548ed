//! How materials name textures.

use bincode::{Decode, Encode};

/// A texture besides the base colour's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Encode, Decode)]
pub struct DetailTexture {
    /// Index of the texture.
    pub texture: u32,
    /// Its coordinates from the vertex's (u, v, 1), row by row.
    pub uv_from_vertex: [[f32; 3]; 2],
}
