//! The records of the bulk sections: fixed little-endian layouts, uploaded to the GPU as they are.
//!
//! | section | record | one per |
//! |---|---|---|
//! | `VERT` | [`Vertex`] | vertex of the render geometry |
//! | `INDX` | `u32` | corner of a triangle; triangles are grouped by [`Draw`](super::meta::Draw) |
//! | `TEXD` | bytes | textures as they came, one after another (PNG, JPEG) |
//! | `PNTS` | [`Point`] | basis function, level after level |
//! | `PUSO`, `PUSE` | `u32`, [`Entry`](crate::interpolation::Entry) | push rows: a point's value from its parents' |
//! | `PULO`, `PULE` | `u32`, [`Entry`](crate::interpolation::Entry) | pull rows: a point's direct light from its children's |
//! | `ROWS` | [`Row`] | receiver with links, and one past the end |
//! | `LINK` | [`Link`](crate::link::Link) | transport link |

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// A vertex of the render geometry. 24 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// Local space (world − the file's origin), scene units.
    pub position: [f32; 3],
    /// Unit shading normal, octahedral snorm16x2.
    pub normal: u32,
    /// Texture coordinates of the base-colour texture, its transform applied.
    pub uv: [f32; 2],
}

/// A basis function: its point and support. 20 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Point {
    /// Local space, scene units.
    pub position: [f32; 3],
    /// Radius of the support, scene units (`r_j` of paper, Eq. 9).
    pub radius: f32,
    /// Unit normal, octahedral snorm16x2.
    pub normal: u32,
}

impl Point {
    /// Position as a vector.
    #[inline]
    pub fn position(&self) -> Vec3 {
        Vec3::from(self.position)
    }

    /// Unit normal as a vector.
    #[inline]
    pub fn normal(&self) -> Vec3 {
        crate::octahedral::unpack_snorm16(self.normal)
    }
}

/// A receiver and where its links begin; they end where the next row's begin. 8 bytes.
/// Receivers ascend. The last row is a sentinel with receiver `u32::MAX`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Row {
    /// Index of the receiving point, over all levels.
    pub receiver: u32,
    /// Index of its first link.
    pub first_link: u32,
}
