//! Records of the bulk sections: fixed little-endian layouts, identical in memory and on the GPU;
//! [`codec`](super::codec) packs the records in the file.
//!
//! | section | record | one per |
//! |---|---|---|
//! | `VERT` | [`Vertex`] | vertex of the render geometry |
//! | `INDX` | `u32` | corner of a triangle; triangles are grouped by [`Draw`](super::meta::Draw) |
//! | `INST` | [`Instance`] | copy of triangles with several placements |
//! | `COPY` | [`Copies`] | draw call, in files with copies |
//! | `TEXD` | bytes | concatenated textures in their original encoding (PNG, JPEG, WebP) |
//! | `PNTS` | [`Point`] | basis function, level after level |
//! | `CUTS` | [`Cut`] | clip plane of a basis function's support |
//! | `LINK` | `u32`, [`Link`](crate::link::Link) | rows of links to all points |
//! | `LATL` | `u32`, [`LaterLink`](crate::link::LaterLink) | rows of links for later bounces between coarse points |

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use std::ops::Range;

/// A vertex of the render geometry. 24 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// Local space (world − the file's origin), scene units; model space for instanced triangles.
    pub position: [f32; 3],
    /// Unit shading normal, octahedral snorm16x2.
    pub normal: u32,
    /// Texture coordinates for the base-colour texture, with the texture transform applied.
    pub uv: [f32; 2],
}

/// Transform of one copy of triangles. 48 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Instance {
    /// Rows x, y, z of the matrix from model space to local space: three factors of the position and a translation.
    /// Not mirrored.
    pub rows: [[f32; 4]; 3],
}

impl Instance {
    /// Transform of triangles with vertices in local space.
    pub const IDENTITY: Self =
        Self { rows: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]] };

    /// The matrix.
    pub fn local_from_model(&self) -> Affine3A {
        let column = |c: usize| Vec3A::new(self.rows[0][c], self.rows[1][c], self.rows[2][c]);
        Affine3A { matrix3: Mat3A::from_cols(column(0), column(1), column(2)), translation: column(3) }
    }
}

impl From<&Affine3A> for Instance {
    fn from(local_from_model: &Affine3A) -> Self {
        let Affine3A { matrix3: m, translation } = local_from_model;
        let row = |r: usize| [m.x_axis[r], m.y_axis[r], m.z_axis[r], translation[r]];
        Self { rows: [row(0), row(1), row(2)] }
    }
}

/// Range of instances of a draw call. 8 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Copies {
    /// Index of the first instance in section `INST`.
    pub first: u32,
    /// Number of instances; 0 for triangles without copies, with vertices in local space.
    pub count: u32,
}

impl Copies {
    /// Indices of the instances.
    pub fn range(&self) -> Range<usize> {
        self.first as usize..self.first as usize + self.count as usize
    }
}

/// Basis function: point and support. 28 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Point {
    /// Local space, scene units.
    pub position: [f32; 3],
    /// Radius of the support, scene units (`r_j` of paper, Eq. 9).
    pub radius: f32,
    /// Unit normal, octahedral snorm16x2.
    pub normal: u32,
    /// Bits 0 to 2: number of the support's cuts. Bits 3 to 10: mask of the [`footprint`](crate::footprint) samples
    /// averaged for direct light. Bits 11 to 31: index of the first cut in section `CUTS`.
    pub cuts: u32,
    /// Colour of light reflected by the surface, rgb9e5; mean of the channels is 1.
    pub tint: u32,
}

/// Maximum number of planes that cut a support.
pub const MAX_CUTS: usize = 4;
/// Maximum number of planes in a file.
pub const MAX_ALL_CUTS: usize = 1 << 21;

/// A plane that ends a support. 12 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Cut {
    /// Vector from the point, perpendicular to the plane; length is the reciprocal of the distance.
    pub towards: [f32; 3],
}

impl Cut {
    /// Returns the plane at `distance` (positive, scene units) from the point along a unit direction. Components are
    /// rounded to ten bits after the leading bit, an error of at most a thousandth of the distance.
    pub fn new(towards: Vec3, distance: f32) -> Self {
        let round = |x: f32| f32::from_bits((x.to_bits() + (1 << 12)) & !((1 << 13) - 1));
        Self { towards: (towards / distance).to_array().map(round) }
    }

    /// True for a place behind the plane; `offset` is relative to the point, scene units.
    #[inline]
    pub fn ends(&self, offset: Vec3) -> bool {
        Vec3::from(self.towards).dot(offset) > 1.0
    }
}

impl Point {
    /// Packs [`Self::cuts`] from the range of cuts and the mask of samples, one bit per sample.
    pub fn pack_cuts(first: usize, count: usize, samples: u8) -> u32 {
        (first as u32) << 11 | (samples as u32) << 3 | count as u32
    }

    /// True if direct light is sampled at this place of the footprint. A point without samples is sampled at its own
    /// position.
    #[inline]
    pub fn has_sample(&self, sample: u32) -> bool {
        self.cuts >> (3 + sample) & 1 != 0
    }

    /// Range of the support's cuts in section `CUTS`.
    #[inline]
    pub fn cuts(&self) -> Range<usize> {
        let first = (self.cuts >> 11) as usize;
        first..first + (self.cuts & 7) as usize
    }

    /// Colour of light reflected by the surface; mean of the channels is 1. Links hold the brightness.
    #[inline]
    pub fn tint(&self) -> Vec3 {
        crate::colour::unpack_rgb9e5(self.tint)
    }

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
