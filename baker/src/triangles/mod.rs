//! Triangles as [`Surfaces`]: a bounding volume hierarchy over all of them.
//!
//! obvhs builds it, [`wide`] makes eight-wide nodes of it. Boxes are padded by some rounding errors, and the triangle
//! test has no gaps, so that what is found equals what trying all triangles finds; a test holds that.

pub mod geometry;
#[cfg(test)]
mod tests;
mod triangle;
mod wide;

pub use geometry::Geometry;

use crate::random::{mix, unit};
use crate::scene::{Scene, SceneError};
use crate::surface::{Hit, Piece, Pieces, Place, Ray, Spot, Surfaces};
use geometry::{Surface, Triangle};
use glam::{Vec2, Vec3, Vec3A};
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams, aabb::Aabb};
use rayon::prelude::*;
use rebounce_shared::rbn;
use rebounce_shared::rbn::meta::Alpha;
use std::ops::ControlFlow;
use triangle::{Corners, Meeting, ShearedRay};
use wide::{LARGEST_LEAF, WideBvh};

/// Ray origins are moved off surfaces by this share of the scene's diagonal. Local coordinates
/// are at most half the diagonal, so an f32 is off by 3e-8 of it and a plane distance over the
/// whole scene by a few times that: ten times more is safe, and 0.1 mm in a 30 m hall.
const EPSILON: f32 = 3e-6;
/// Boxes grow by this share of the diagonal, for the rounding of the box test.
const PADDING: f32 = 5e-7;

/// Marks a triangle's number.
const TRANSPARENT: u32 = 1 << 31;

/// A triangle's marks: that it reflects on both sides.
const TWO_SIDED: u8 = 1 << 2;
/// That its front, the side of its shading normals, is the one from where its corners go clockwise.
const TURNED: u8 = 1 << 3;
/// Which corner is across from its longest side: [`Place::at`] counts from there.
const FIRST: u8 = 3;

/// What a triangle looks like: one cache line, of which the walk reads nothing.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Look {
    normals: [Vec3; 3],
    uvs: [Vec2; 3],
    material: u32,
}

/// Triangles with textures and alpha.
pub struct TriangleSurfaces {
    bvh: WideBvh,
    /// In the order of the hierarchy's leaves.
    corners: Vec<Corners>,
    /// Each triangle's number as it came, and [`TRANSPARENT`] where a hit may be none.
    numbers: Vec<u32>,
    marks: Vec<u8>,
    looks: Vec<Look>,
    /// The vertices' colours, in the same order, or none.
    colors: Vec<[Vec3; 3]>,
    surfaces: Vec<Surface>,
    low: Vec3,
    high: Vec3,
    epsilon: f32,
}

impl From<&Triangle> for Look {
    fn from(triangle: &Triangle) -> Self {
        let &Triangle { normals, uvs, material, .. } = triangle;
        Self { normals, uvs, material }
    }
}

impl Look {
    /// The shading normal at a place, by the shares of the corners; zero where they cancel out.
    #[inline]
    fn normal(&self, [u, v, w]: [f32; 3]) -> Vec3 {
        (self.normals[0] * u + self.normals[1] * v + self.normals[2] * w).normalize_or_zero()
    }

    #[inline]
    fn uv(&self, [u, v, w]: [f32; 3]) -> Vec2 {
        self.uvs[0] * u + self.uvs[1] * v + self.uvs[2] * w
    }

    /// The share of the texture on a unit of area; `spanned` are the [corners'](Corners::spanned).
    #[inline]
    fn share(&self, spanned: Vec3) -> f32 {
        let [p, q, r] = self.uvs;
        (q - p).perp_dot(r - p).abs() / spanned.length().max(f32::MIN_POSITIVE)
    }
}

struct Padded(Aabb);

impl Boundable for Padded {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

impl TriangleSurfaces {
    /// Builds the hierarchy.
    pub fn new(geometry: Geometry) -> Self {
        let least = |(a, b): (Vec3, Vec3), (c, d): (Vec3, Vec3)| (a.min(c), b.max(d));
        let sides = |t: &Triangle| {
            let [a, b, c] = t.positions;
            (a.min(b).min(c), a.max(b).max(c))
        };
        let (low, high) = geometry.triangles.par_iter().map(sides).reduce_with(least).unwrap_or_default();
        let diagonal = (high - low).length();
        let padding = Vec3A::splat(PADDING * diagonal);
        let padded = |t: &Triangle| {
            let (low, high) = sides(t);
            Padded(Aabb::new(Vec3A::from(low) - padding, Vec3A::from(high) + padding))
        };
        let boxes: Vec<Padded> = geometry.triangles.par_iter().map(padded).collect();
        let (bvh, order) = if boxes.is_empty() {
            Default::default()
        } else {
            let build = BvhBuildParams { max_prims_per_leaf: LARGEST_LEAF, ..BvhBuildParams::medium_build() };
            WideBvh::new(&build_bvh2(&boxes, build, &mut Default::default()))
        };
        drop(boxes);
        // In the hierarchy's order.
        let ordered = || order.par_iter().map(|&i| (i, &geometry.triangles[i as usize]));
        let surface = |t: &Triangle| &geometry.surfaces[t.material as usize];
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
                .map(|(i, t)| i | if surface(t).alpha != Alpha::Opaque { TRANSPARENT } else { 0 })
                .collect(),
            marks: ordered().map(|(_, t)| marks(t)).collect(),
            looks: ordered().map(|(_, t)| Look::from(t)).collect(),
            colors: match geometry.colors[..] {
                [] => Vec::new(),
                _ => ordered().map(|(i, _)| geometry.colors[i as usize]).collect(),
            },
            surfaces: geometry.surfaces,
            low,
            high,
            epsilon: (EPSILON * diagonal).max(f32::MIN_POSITIVE),
        }
    }

    /// The surfaces of a loaded scene.
    pub fn from_scene(scene: &Scene) -> Self {
        Self::new(Geometry::from(scene))
    }

    /// The surfaces of a loaded scene, of as few triangles as they need.
    pub fn simplified(scene: &Scene) -> Self {
        Self::new(Geometry::simplified(scene))
    }

    /// The surfaces of a baked file.
    ///
    /// # Errors
    /// [`SceneError::Texture`] where a picture cannot be decoded.
    pub fn from_baked(scene: &rbn::Scene) -> Result<Self, SceneError> {
        Ok(Self::new(Geometry::try_from(scene)?))
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.corners.len()
    }

    /// The share of light that a triangle stops at a place.
    #[inline]
    fn opacity(&self, triangle: usize, m: Meeting) -> f32 {
        let look = &self.looks[triangle];
        self.surfaces[look.material as usize].opacity(look.uv(m.shares()))
    }

    /// Whether a triangle that may be transparent stops the ray with this seed.
    fn stops(&self, triangle: usize, m: Meeting, seed: u32) -> bool {
        let opacity = self.opacity(triangle, m);
        opacity >= 1.0
            || (opacity > 0.0 && unit(mix((seed as u64) << 32 | self.numbers[triangle] as u64)) < opacity)
    }

    /// A vector across a triangle, on the side of its front.
    #[inline]
    fn front(&self, triangle: usize) -> Vec3 {
        let spanned = self.corners[triangle].spanned();
        if self.marks[triangle] & TURNED == 0 { spanned } else { -spanned }
    }

    /// The factor of the albedo, by the shares of a triangle's corners.
    #[inline]
    fn color(&self, triangle: usize, [u, v, w]: [f32; 3]) -> Vec3 {
        match self.colors.get(triangle) {
            Some(c) => c[0] * u + c[1] * v + c[2] * w,
            None => self.surfaces[self.looks[triangle].material as usize].color,
        }
    }

    fn shade(&self, triangle: usize, m: Meeting, ray: &Ray) -> Hit {
        let direction = ray.direction;
        let (look, corners) = (&self.looks[triangle], &self.corners[triangle]);
        let [a, b, c] = corners.positions();
        let spanned = self.front(triangle);
        let geometric_normal = match spanned.normalize_or_zero() {
            Vec3::ZERO => -direction,
            outwards if outwards.dot(direction) > 0.0 => -outwards,
            outwards => outwards,
        };
        let surface = &self.surfaces[look.material as usize];
        let mut normal = match look.normal(m.shares()) {
            Vec3::ZERO => geometric_normal,
            normal => normal,
        };
        let mut faces = normal.dot(direction) < 0.0;
        if !faces && surface.double_sided {
            normal = -normal;
            faces = true;
        }
        let (albedo, emission) = if faces {
            let share = look.share(spanned) * (ray.spread * m.distance).powi(2);
            let color = self.color(triangle, m.shares());
            (surface.albedo(color, look.uv(m.shares()), share), surface.emission)
        } else {
            (Vec3::ZERO, Vec3::ZERO)
        };
        let position = a + (b - a) * m.v + (c - a) * m.w;
        Hit { distance: m.distance, position, geometric_normal, normal, albedo, emission }
    }
}

impl TriangleSurfaces {
    /// Where a ray meets the nearest surface, and nothing about it: what of [`Surfaces::cast`] is the walk through the
    /// hierarchy.
    #[inline]
    pub fn distance(&self, ray: &Ray, seed: u32) -> Option<f32> {
        self.nearest(ray, seed).map(|(_, meeting)| meeting.distance)
    }

    /// The nearest triangle that stops the ray.
    #[inline(never)]
    fn nearest(&self, ray: &Ray, seed: u32) -> Option<(usize, Meeting)> {
        let sheared = ShearedRay::new(ray.origin, ray.direction);
        let mut best: Option<(usize, Meeting)> = None;
        self.bvh.walk(ray.origin, ray.direction, ray.max_distance, |place, limit| {
            let Some(meeting) = self.corners[place].meet(&sheared, limit) else {
                return ControlFlow::Continue(limit);
            };
            let number = self.numbers[place];
            // Of two triangles at one place the first counts, in whatever order they are met.
            let nearer = meeting.distance < limit || best.is_none_or(|(p, _)| number < self.numbers[p]);
            if nearer && (number & TRANSPARENT == 0 || self.stops(place, meeting, seed)) {
                best = Some((place, meeting));
                return ControlFlow::Continue(meeting.distance);
            }
            ControlFlow::Continue(limit)
        });
        best
    }
}

impl Pieces for TriangleSurfaces {
    fn count(&self) -> usize {
        self.corners.len()
    }

    fn piece(&self, piece: u32) -> Piece {
        let (corners, piece) = (&self.corners[piece as usize], piece as usize);
        let first = (self.marks[piece] & FIRST) as usize;
        let [a, b, c] = corners.positions();
        let (at, next, last) = [(a, b, c), (b, c, a), (c, a, b)][first];
        Piece {
            sides: [at.distance(next), at.distance(last)],
            has_back: self.marks[piece] & TWO_SIDED != 0,
            middle: (a + b + c) / 3.0,
            normal: self.looks[piece].normals.into_iter().sum::<Vec3>().normalize_or_zero(),
            kind: self.looks[piece].material,
        }
    }

    fn spot(&self, place: Place, area: f32) -> Spot {
        let piece = place.piece as usize;
        let (look, corners) = (&self.looks[piece], &self.corners[piece]);
        let [u, v, w] = [1.0 - place.at.x - place.at.y, place.at.x, place.at.y];
        let shares = match self.marks[piece] & FIRST {
            0 => [u, v, w],
            1 => [w, u, v],
            _ => [v, w, u],
        };
        let surface = &self.surfaces[look.material as usize];
        let spanned = self.front(piece);
        let normal = match look.normal(shares) {
            Vec3::ZERO => spanned.normalize_or_zero(),
            normal => normal,
        };
        let (uv, [a, b, c]) = (look.uv(shares), corners.positions());
        Spot {
            position: a * shares[0] + b * shares[1] + c * shares[2],
            normal: if place.is_back { -normal } else { normal },
            albedo: surface.albedo(self.color(piece, shares), uv, look.share(spanned) * area),
            opacity: surface.opacity(uv),
        }
    }

    fn find(&self, ray: &Ray, seed: u32) -> Option<(Place, f32)> {
        let (piece, meeting) = self.nearest(ray, seed)?;
        let is_back = self.front(piece).dot(ray.direction) > 0.0;
        let marks = self.marks[piece];
        if is_back && marks & TWO_SIDED == 0 {
            return None;
        }
        let [u, v, w] = meeting.shares();
        let at = match marks & FIRST {
            0 => Vec2::new(v, w),
            1 => Vec2::new(w, u),
            _ => Vec2::new(u, v),
        };
        Some((Place { piece: piece as u32, at, is_back }, meeting.distance))
    }
}

impl Surfaces for TriangleSurfaces {
    fn cast(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        let (place, meeting) = self.nearest(ray, seed)?;
        Some(self.shade(place, meeting, ray))
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> f32 {
        let offset = to - from;
        let length = offset.length();
        // A light may touch a surface: what is there does not hide it.
        let limit = length - self.epsilon;
        if limit <= 0.0 {
            return 1.0;
        }
        let direction = offset / length;
        let sheared = ShearedRay::new(from, direction);
        let mut left = 1.0f32;
        self.bvh.walk(from, direction, limit, |place, limit| {
            if let Some(meeting) = self.corners[place].meet(&sheared, limit) {
                if self.numbers[place] & TRANSPARENT == 0 {
                    left = 0.0;
                } else {
                    left *= 1.0 - self.opacity(place, meeting);
                }
                if left <= 0.0 {
                    return ControlFlow::Break(());
                }
            }
            ControlFlow::Continue(limit)
        });
        left.max(0.0)
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        (self.low, self.high)
    }

    fn epsilon(&self) -> f32 {
        self.epsilon
    }

    fn pieces(&self) -> Option<&dyn Pieces> {
        Some(self)
    }
}
