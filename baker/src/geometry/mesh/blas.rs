//! Bottom-level acceleration structure (BLAS): the triangles of one space in the order of a [BVH8](crate::geometry::bvh8)'s
//! leaves, with shading attributes. Answers nearest-hit, visibility and transmittance queries for a single ray;
//! bundles of rays use [packet traversal](super::packet_traversal).

use super::geometry::{Surface, Triangle, WITH_LIGHTMAPS};
use super::triangle::{Corners, ShearedRay, TriangleHit};
use crate::geometry::bvh8::{Bvh8, LARGEST_LEAF, PaddedBox, Visit, build};
use crate::random::{mix, unit};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::ops::ControlFlow;

/// Flag in a triangle's number: the triangle may let a ray pass.
const TRANSPARENT: u32 = 1 << 31;

/// Flag in a triangle's marks: the triangle reflects on both sides.
pub(super) const TWO_SIDED: u8 = 1 << 2;
/// Flag in a triangle's marks: the front, the side of the shading normals, is the side with clockwise corners.
const TURNED: u8 = 1 << 3;
/// Mask in a triangle's marks: index of the corner opposite the longest side, the origin of
/// [`SurfaceCoordinates::at`](crate::geometry::SurfaceCoordinates::at).
pub(super) const FIRST: u8 = 3;

/// Shading attributes of a triangle: one cache line, never read by the traversal.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct ShadingAttributes {
    pub normals: [Vec3; 3],
    uvs: [Vec2; 3],
    pub material: u32,
}

impl From<&Triangle> for ShadingAttributes {
    fn from(triangle: &Triangle) -> Self {
        let &Triangle { normals, uvs, material, .. } = triangle;
        Self { normals, uvs, material }
    }
}

impl ShadingAttributes {
    #[inline]
    pub fn uv(&self, [u, v, w]: [f32; 3]) -> Vec2 {
        self.uvs[0] * u + self.uvs[1] * v + self.uvs[2] * w
    }

    /// Returns the fraction of the texture per unit of area; `spanned` is the [corners'](Corners::spanned) area
    /// vector.
    #[inline]
    pub fn share(&self, spanned: Vec3) -> f32 {
        let [p, q, r] = self.uvs;
        (q - p).perp_dot(r - p).abs() / spanned.length().max(f32::MIN_POSITIVE)
    }
}

/// Ray in the space of a BLAS. The direction may have any length; distances are in units of this length.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalRay {
    pub origin: Vec3,
    pub direction: Vec3,
}

/// Triangles of one space, with a BVH8.
pub(super) struct Blas {
    pub bvh: Bvh8,
    /// Corners by triangle, in leaf order.
    pub corners: Vec<Corners>,
    /// Original number by triangle, with the flag [`TRANSPARENT`] if the triangle may let a ray pass.
    numbers: Vec<u32>,
    pub marks: Vec<u8>,
    pub attributes: Vec<ShadingAttributes>,
    /// Vertex colours by triangle, in leaf order; empty without vertex colours.
    colors: Vec<[Vec3; 3]>,
    /// Places in a lightmap by triangle, texels, in leaf order; empty without a lightmap.
    lightmap: Vec<[Vec2; 3]>,
}

impl Blas {
    /// Builds the BVH8 over these triangles; the first triangle has the number `first`. Boxes grow by the `padding`.
    pub fn new(
        triangles: &[Triangle],
        (colors, lightmap): (&[[Vec3; 3]], &[[Vec2; 3]]),
        first: u32,
        surfaces: &[Surface],
        padding: f32,
    ) -> Self {
        let boxes: Vec<PaddedBox> =
            triangles.par_iter().map(|t| PaddedBox::new(t.bounds(), padding)).collect();
        let (bvh, order) = build(&boxes, LARGEST_LEAF);
        drop(boxes);
        // In leaf order.
        let ordered = || order.par_iter().map(|&i| (i, &triangles[i as usize]));
        let surface = |t: &Triangle| &surfaces[t.material as usize];
        let marks = |t: &Triangle| {
            let corners = Corners::new(t.positions);
            let is_turned = corners.spanned().dot(t.normals.into_iter().sum()) < 0.0;
            let mark = |is: bool, mark| if is { mark } else { 0 };
            corners.first() as u8 | mark(surface(t).double_sided, TWO_SIDED) | mark(is_turned, TURNED)
        };
        Self {
            bvh,
            corners: ordered().map(|(_, t)| Corners::new(t.positions)).collect(),
            numbers: ordered()
                .map(|(i, t)| (first + i) | if !surface(t).is_opaque() { TRANSPARENT } else { 0 })
                .collect(),
            marks: ordered().map(|(_, t)| marks(t)).collect(),
            attributes: ordered().map(|(_, t)| ShadingAttributes::from(t)).collect(),
            colors: match colors {
                [] => Vec::new(),
                _ => ordered().map(|(i, _)| colors[i as usize]).collect(),
            },
            lightmap: match lightmap {
                _ if !WITH_LIGHTMAPS => Vec::new(),
                [] => Vec::new(),
                _ => ordered().map(|(i, _)| lightmap[i as usize]).collect(),
            },
        }
    }

    /// Returns the transmittance of a triangle at a hit, linear RGB.
    #[inline]
    fn through(&self, surfaces: &[Surface], triangle: usize, m: TriangleHit) -> Vec3 {
        let look = &self.attributes[triangle];
        let color = self.color(surfaces, triangle, m.shares());
        surfaces[look.material as usize].through(color, look.uv(m.shares()))
    }

    /// Returns whether a triangle with transparency stops the ray with this seed.
    fn stops(&self, surfaces: &[Surface], triangle: usize, m: TriangleHit, seed: u32) -> bool {
        let look = &self.attributes[triangle];
        let color = self.color(surfaces, triangle, m.shares());
        let opacity = surfaces[look.material as usize].opacity(color, look.uv(m.shares()));
        opacity >= 1.0
            || (opacity > 0.0 && unit(mix((seed as u64) << 32 | self.numbers[triangle] as u64)) < opacity)
    }

    /// Returns a normal vector on a triangle's front; the length is twice the triangle's area.
    #[inline]
    pub fn front(&self, triangle: usize) -> Vec3 {
        let spanned = self.corners[triangle].spanned();
        if self.marks[triangle] & TURNED == 0 { spanned } else { -spanned }
    }

    /// Returns whether a ray in this direction hits the back of a one-sided triangle.
    #[inline]
    pub fn is_dark(&self, triangle: usize, direction: Vec3) -> bool {
        self.marks[triangle] & TWO_SIDED == 0 && self.front(triangle).dot(direction) > 0.0
    }

    /// Returns the factor of the albedo at barycentric weights of a triangle's corners.
    #[inline]
    pub fn color(&self, surfaces: &[Surface], triangle: usize, [u, v, w]: [f32; 3]) -> Vec3 {
        match self.colors.get(triangle) {
            Some(c) => c[0] * u + c[1] * v + c[2] * w,
            None => surfaces[self.attributes[triangle].material as usize].color,
        }
    }

    /// Returns the place in the lightmap at barycentric weights of a triangle's corners, texels, before the offset of the copy;
    /// `None` without a chart.
    #[inline]
    pub fn lightmap(&self, triangle: usize, [u, v, w]: [f32; 3]) -> Option<Vec2> {
        if !WITH_LIGHTMAPS {
            return None;
        }
        let at = self.lightmap.get(triangle)?;
        Some(at[0] * u + at[1] * v + at[2] * w).filter(|at| !at.is_nan())
    }

    /// Returns the nearest triangle stopping the ray at or before `limit`, with `strictly` before `limit`; as index in
    /// leaf order, and the hit.
    #[inline(never)]
    pub fn nearest(
        &self,
        surfaces: &[Surface],
        line: &LocalRay,
        limit: f32,
        strictly: bool,
        seed: u32,
    ) -> Option<(usize, TriangleHit)> {
        let sheared = ShearedRay::new(line.origin, line.direction);
        let stop = NearestSoFar { blas: self, surfaces, strictly, seed, best: None };
        let nearest = Nearest { stop, sheared };
        self.bvh.walk(line.origin, line.direction, limit, nearest)
    }

    /// As [`Self::nearest`], with backs of one-sided triangles culled.
    #[inline(never)]
    pub fn nearest_seen(
        &self,
        surfaces: &[Surface],
        line: &LocalRay,
        limit: f32,
        strictly: bool,
        seed: u32,
    ) -> Option<(usize, TriangleHit)> {
        let sheared = ShearedRay::new(line.origin, line.direction);
        let stop = NearestSoFar { blas: self, surfaces, strictly, seed, best: None };
        let seen = NearestSeen { nearest: Nearest { stop, sheared }, direction: line.direction };
        self.bvh.walk(line.origin, line.direction, limit, seen)
    }

    /// Returns the transmittance of the triangles before `limit`, linear RGB.
    pub fn transmittance(&self, surfaces: &[Surface], line: &LocalRay, limit: f32) -> Vec3 {
        let sheared = ShearedRay::new(line.origin, line.direction);
        let through = Through { blas: self, surfaces, sheared, left: Vec3::ONE };
        self.bvh.walk(line.origin, line.direction, limit, through).max(Vec3::ZERO)
    }

    /// Returns the product, over the triangles before `limit`, of transmittance over mean transmittance, linear RGB.
    /// If the ray comes `from_eye`, backs of one-sided triangles are culled.
    pub fn tint(&self, surfaces: &[Surface], line: &LocalRay, limit: f32, from_eye: bool) -> Vec3 {
        let sheared = ShearedRay::new(line.origin, line.direction);
        let mut tint = Vec3::ONE;
        let mut visit = |place: usize, limit: f32| {
            // The triangle at the limit has stopped the ray.
            if self.numbers[place] & TRANSPARENT != 0
                && !(from_eye && self.is_dark(place, line.direction))
                && let Some(meeting) = self.corners[place].meet(&sheared, limit)
                && meeting.distance < limit
            {
                let through = self.through(surfaces, place, meeting);
                let mean = through.element_sum() / 3.0;
                tint *= if mean > 0.0 { through / mean } else { Vec3::ONE };
            }
            ControlFlow::Continue(limit)
        };
        self.bvh.walk(line.origin, line.direction, limit, &mut visit);
        tint
    }
}

/// State of a nearest-hit query.
pub(super) struct NearestSoFar<'a> {
    pub blas: &'a Blas,
    pub surfaces: &'a [Surface],
    pub strictly: bool,
    pub seed: u32,
    /// Triangle of the nearest hit, as index in leaf order, and the hit.
    pub best: Option<(usize, TriangleHit)>,
}

impl NearestSoFar<'_> {
    /// Adds a hit of a triangle to the query, with the ray's current `limit`; returns the new limit.
    #[inline(always)]
    pub fn take(&mut self, place: usize, meeting: TriangleHit, limit: f32) -> f32 {
        let blas = self.blas;
        let number = blas.numbers[place];
        // Of two triangles at equal distance the first number counts, in any order of traversal.
        let nearer = meeting.distance < limit
            || match self.best {
                Some((place, _)) => number < blas.numbers[place],
                None => !self.strictly,
            };
        if nearer && (number & TRANSPARENT == 0 || blas.stops(self.surfaces, place, meeting, self.seed)) {
            self.best = Some((place, meeting));
            return meeting.distance;
        }
        limit
    }
}

/// Visitor for the nearest triangle stopping a ray.
pub(super) struct Nearest<'a> {
    pub stop: NearestSoFar<'a>,
    pub sheared: ShearedRay,
}

impl Visit for Nearest<'_> {
    type Found = Option<(usize, TriangleHit)>;

    #[inline(always)]
    fn visit(&mut self, place: usize, limit: f32) -> ControlFlow<(), f32> {
        ControlFlow::Continue(match self.stop.blas.corners[place].meet(&self.sheared, limit) {
            Some(meeting) => self.stop.take(place, meeting, limit),
            None => limit,
        })
    }

    #[inline(always)]
    fn found(self) -> Self::Found {
        self.stop.best
    }
}

/// Visitor for the nearest triangle seen by a camera along a ray.
struct NearestSeen<'a> {
    nearest: Nearest<'a>,
    direction: Vec3,
}

impl Visit for NearestSeen<'_> {
    type Found = Option<(usize, TriangleHit)>;

    #[inline(always)]
    fn visit(&mut self, place: usize, limit: f32) -> ControlFlow<(), f32> {
        if self.nearest.stop.blas.is_dark(place, self.direction) {
            return ControlFlow::Continue(limit);
        }
        self.nearest.visit(place, limit)
    }

    #[inline(always)]
    fn found(self) -> Self::Found {
        self.nearest.found()
    }
}

/// Visitor for the product of transmittances along a ray.
struct Through<'a> {
    blas: &'a Blas,
    surfaces: &'a [Surface],
    sheared: ShearedRay,
    left: Vec3,
}

impl Visit for Through<'_> {
    type Found = Vec3;

    #[inline(always)]
    fn visit(&mut self, place: usize, limit: f32) -> ControlFlow<(), f32> {
        let blas = self.blas;
        if let Some(meeting) = blas.corners[place].meet(&self.sheared, limit) {
            if blas.numbers[place] & TRANSPARENT == 0 {
                self.left = Vec3::ZERO;
            } else {
                self.left *= blas.through(self.surfaces, place, meeting);
            }
            if self.left.max_element() <= 0.0 {
                return ControlFlow::Break(());
            }
        }
        ControlFlow::Continue(limit)
    }

    #[inline(always)]
    fn found(self) -> Self::Found {
        self.left
    }
}
