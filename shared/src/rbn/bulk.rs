//! The records of the bulk sections: fixed little-endian layouts, as they are in memory and on the GPU; [`codec`](super::codec) packs them in the file.
//!
//! | section | record | one per |
//! |---|---|---|
//! | `VERT` | [`Vertex`] | vertex of the render geometry |
//! | `INDX` | `u32` | corner of a triangle; triangles are grouped by [`Draw`](super::meta::Draw) |
//! | `INST` | [`Instance`] | copy of triangles that stand in more than one place |
//! | `COPY` | [`Copies`] | draw call, of files with copies |
//! | `TEXD` | bytes | textures as they came, one after another (PNG, JPEG, WebP) |
//! | `PNTS` | [`Point`] | basis function, level after level |
//! | `CUTS` | [`Cut`] | plane that ends a basis function's support |
//! | `LINK` | `u32`, [`Link`](crate::link::Link) | rows of links to all points |
//! | `LATL` | `u32`, [`LaterLink`](crate::link::LaterLink) | rows of links for later bounces between coarse points |

use bytemuck::{Pod, Zeroable};
use glam::{Affine3A, Mat3A, Vec3, Vec3A};
use std::ops::Range;

/// A vertex of the render geometry. 24 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// Local space (world − the file's origin), scene units; of triangles with copies, a space of their own.
    pub position: [f32; 3],
    /// Unit shading normal, octahedral snorm16x2.
    pub normal: u32,
    /// Texture coordinates of the base-colour texture, its transform applied.
    pub uv: [f32; 2],
}

/// Where a copy of triangles stands. 48 bytes.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Instance {
    /// Rows x, y, z of the matrix that takes the triangles' space to local space: three numbers that positions are
    /// multiplied with, and one that is added. Not mirrored.
    pub rows: [[f32; 4]; 3],
}

impl Instance {
    /// Where triangles stand whose vertices are in local space.
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

/// Which instances a draw call's triangles have. 8 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
#[repr(C)]
pub struct Copies {
    /// Index of the first one in section `INST`.
    pub first: u32,
    /// How many there are; 0 for triangles that stand once, their vertices in local space.
    pub count: u32,
}

impl Copies {
    /// Their indices.
    pub fn range(&self) -> Range<usize> {
        self.first as usize..self.first as usize + self.count as usize
    }
}

/// A basis function: its point and support. 28 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Point {
    /// Local space, scene units.
    pub position: [f32; 3],
    /// Radius of the support, scene units (`r_j` of paper, Eq. 9).
    pub radius: f32,
    /// Unit normal, octahedral snorm16x2.
    pub normal: u32,
    /// Bits 0 to 2: number of the support's cuts; 3 to 10: which samples of
    /// [`footprint`](crate::footprint) its direct light is the mean of; 11 to 31: index of its first cut in
    /// section `CUTS`.
    pub cuts: u32,
    /// What colour the surface gives to light, rgb9e5; the channels' mean is 1.
    pub tint: u32,
}

/// Planes that cut one support off, at most.
pub const MAX_CUTS: usize = 4;
/// Planes in a file, at most.
pub const MAX_ALL_CUTS: usize = 1 << 21;

/// A plane that ends a support. 12 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Cut {
    /// From the point at right angles to the plane; its length is one over the distance.
    pub towards: [f32; 3],
}

impl Cut {
    /// The plane at this `distance` (positive, scene units) from the point in a unit direction. Its numbers are
    /// rounded to ten bits after the leading one, which moves it by at most a thousandth of the distance.
    pub fn new(towards: Vec3, distance: f32) -> Self {
        let round = |x: f32| f32::from_bits((x.to_bits() + (1 << 12)) & !((1 << 13) - 1));
        Self { towards: (towards / distance).to_array().map(round) }
    }

    /// True behind the plane; `offset` is from the point, scene units.
    #[inline]
    pub fn ends(&self, offset: Vec3) -> bool {
        Vec3::from(self.towards).dot(offset) > 1.0
    }
}

impl Point {
    /// [`Self::cuts`] for a support with this many cuts and these samples, one bit a sample.
    pub fn pack_cuts(first: usize, count: usize, samples: u8) -> u32 {
        (first as u32) << 11 | (samples as u32) << 3 | count as u32
    }

    /// True where the point's direct light is sampled at this place of its footprint. Where it is at
    /// none, it is sampled at the point.
    #[inline]
    pub fn has_sample(&self, sample: u32) -> bool {
        self.cuts >> (3 + sample) & 1 != 0
    }

    /// Where the support's cuts are in section `CUTS`.
    #[inline]
    pub fn cuts(&self) -> Range<usize> {
        let first = (self.cuts >> 11) as usize;
        first..first + (self.cuts & 7) as usize
    }

    /// What colour the surface gives to light; the channels' mean is 1. How bright it is, the links say.
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
