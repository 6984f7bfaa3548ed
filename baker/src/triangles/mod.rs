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
use glam::{Vec2, Vec3, Vec3A, Vec4};
use obvhs::bvh2::builder::build_bvh2;
use obvhs::{Boundable, BvhBuildParams, aabb::Aabb};
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

/// Marks a triangle's first corner.
const TWO_SIDED: u8 = 4;

/// Triangles with textures and alpha.
pub struct TriangleSurfaces {
    bvh: WideBvh,
    /// In the order of the hierarchy's leaves.
    corners: Vec<Corners>,
    /// Each triangle's number as it came, and [`TRANSPARENT`] where a hit may be none.
    numbers: Vec<u32>,
    triangles: Vec<Triangle>,
    /// Each triangle's unit normal, or zero, on the side of its shading normals, and the share of its texture that a
    /// unit of its area holds.
    planes: Vec<Vec4>,
    /// Each triangle's corner across from its longest side, where [`Place::at`] counts from, and [`TWO_SIDED`] where it
    /// reflects on both sides.
    firsts: Vec<u8>,
    /// The vertices' colours, in the same order, or none.
    colors: Vec<[Vec3; 3]>,
    surfaces: Vec<Surface>,
    low: Vec3,
    high: Vec3,
    epsilon: f32,
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
        let corners = geometry.triangles.iter().flat_map(|t| t.positions);
        let (low, high) = corners
            .fold(None, |b: Option<(Vec3, Vec3)>, p| Some(b.map_or((p, p), |(l, h)| (l.min(p), h.max(p)))))
            .unwrap_or_default();
        let diagonal = (high - low).length();
        let padding = Vec3A::splat(PADDING * diagonal);
        let boxes: Vec<Padded> = geometry
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.positions.map(Vec3A::from);
                Padded(Aabb::new(a.min(b).min(c) - padding, a.max(b).max(c) + padding))
            })
            .collect();
        let (bvh, order) = if boxes.is_empty() {
            Default::default()
        } else {
            let build = BvhBuildParams { max_prims_per_leaf: LARGEST_LEAF, ..BvhBuildParams::medium_build() };
            WideBvh::new(&build_bvh2(&boxes, build, &mut Default::default()))
        };
        let triangles: Vec<Triangle> = order.iter().map(|&i| geometry.triangles[i as usize]).collect();
        let transparent = |t: &Triangle| geometry.surfaces[t.material as usize].alpha != Alpha::Opaque;
        Self {
            corners: triangles.iter().map(|t| Corners::new(t.positions)).collect(),
            numbers: (triangles.iter().zip(&order))
                .map(|(t, i)| i | if transparent(t) { TRANSPARENT } else { 0 })
                .collect(),
            colors: if geometry.colors.is_empty() {
                Vec::new()
            } else {
                order.iter().map(|&i| geometry.colors[i as usize]).collect()
            },
            planes: triangles.iter().map(plane).collect(),
            firsts: (triangles.iter())
                .map(|t| {
                    first(t) | if geometry.surfaces[t.material as usize].double_sided { TWO_SIDED } else { 0 }
                })
                .collect(),
            triangles,
            bvh,
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

    /// The surfaces of a baked file.
    ///
    /// # Errors
    /// [`SceneError::Texture`] where a picture cannot be decoded.
    pub fn from_baked(scene: &rbn::Scene) -> Result<Self, SceneError> {
        Ok(Self::new(Geometry::try_from(scene)?))
    }

    /// Number of triangles.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// Whether the hit counts for a ray with this seed, and the share of light that it stops.
    #[inline]
    fn opacity(&self, place: usize, m: Meeting) -> f32 {
        let t = &self.triangles[place];
        let uv = t.uvs[0] * (1.0 - m.v - m.w) + t.uvs[1] * m.v + t.uvs[2] * m.w;
        self.surfaces[t.material as usize].opacity(uv)
    }

    /// Whether a triangle that may be transparent stops the ray with this seed.
    fn stops(&self, place: usize, m: Meeting, seed: u32) -> bool {
        let opacity = self.opacity(place, m);
        opacity >= 1.0
            || (opacity > 0.0 && unit(mix((seed as u64) << 32 | self.numbers[place] as u64)) < opacity)
    }

    /// The factor of the albedo, by the shares of a triangle's corners.
    #[inline]
    fn color(&self, place: usize, [u, v, w]: [f32; 3]) -> Vec3 {
        match self.colors.get(place) {
            Some(c) => c[0] * u + c[1] * v + c[2] * w,
            None => self.surfaces[self.triangles[place].material as usize].color,
        }
    }

    fn shade(&self, place: usize, m: Meeting, ray: &Ray) -> Hit {
        let direction = ray.direction;
        let t = &self.triangles[place];
        let [a, b, c] = t.positions;
        let (u, plane) = (1.0 - m.v - m.w, self.planes[place]);
        let geometric_normal = match plane.truncate() {
            Vec3::ZERO => -direction,
            outwards if outwards.dot(direction) > 0.0 => -outwards,
            outwards => outwards,
        };
        let surface = &self.surfaces[t.material as usize];
        let mut normal =
            (t.normals[0] * u + t.normals[1] * m.v + t.normals[2] * m.w).normalize_or(geometric_normal);
        let mut faces = normal.dot(direction) < 0.0;
        if !faces && surface.double_sided {
            normal = -normal;
            faces = true;
        }
        let (albedo, emission) = if faces {
            let uv = t.uvs[0] * u + t.uvs[1] * m.v + t.uvs[2] * m.w;
            let share = plane.w * (ray.spread * m.distance).powi(2);
            (surface.albedo(self.color(place, [u, m.v, m.w]), uv, share), surface.emission)
        } else {
            (Vec3::ZERO, Vec3::ZERO)
        };
        let position = a + (b - a) * m.v + (c - a) * m.w;
        Hit { distance: m.distance, position, geometric_normal, normal, albedo, emission }
    }
}

/// A triangle's unit normal, or zero, on the side of its shading normals, and the share of its texture that a unit of its
/// area holds.
fn plane(t: &Triangle) -> Vec4 {
    let ([a, b, c], [p, q, r]) = (t.positions, t.uvs);
    let spanned = (b - a).cross(c - a);
    let share = (q - p).perp_dot(r - p).abs() / spanned.length().max(f32::MIN_POSITIVE);
    let normal = spanned.normalize_or_zero();
    let faces = normal.dot(t.normals.into_iter().sum()) >= 0.0;
    (if faces { normal } else { -normal }).extend(share)
}

/// The corner across from a triangle's longest side.
fn first(t: &Triangle) -> u8 {
    let [a, b, c] = t.positions;
    let sides = [b.distance_squared(c), c.distance_squared(a), a.distance_squared(b)];
    let longest = |best: usize, i: usize| if sides[i] > sides[best] { i } else { best };
    (0..3).fold(0, longest) as u8
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
        self.triangles.len()
    }

    fn piece(&self, piece: u32) -> Piece {
        let t = &self.triangles[piece as usize];
        let marked = self.firsts[piece as usize];
        let first = (marked & !TWO_SIDED) as usize;
        let corner = |i: usize| t.positions[(first + i) % 3];
        Piece {
            sides: [corner(0).distance(corner(1)), corner(0).distance(corner(2))],
            has_back: marked & TWO_SIDED != 0,
        }
    }

    fn spot(&self, place: Place, area: f32) -> Spot {
        let piece = place.piece as usize;
        let t = &self.triangles[piece];
        let mut shares = [1.0 - place.at.x - place.at.y, place.at.x, place.at.y];
        shares.rotate_right((self.firsts[piece] & !TWO_SIDED) as usize);
        let [u, v, w] = shares;
        let surface = &self.surfaces[t.material as usize];
        let plane = self.planes[piece];
        let normal = (t.normals[0] * u + t.normals[1] * v + t.normals[2] * w).normalize_or(plane.truncate());
        let uv = t.uvs[0] * u + t.uvs[1] * v + t.uvs[2] * w;
        Spot {
            position: t.positions[0] * u + t.positions[1] * v + t.positions[2] * w,
            normal: if place.is_back { -normal } else { normal },
            albedo: surface.albedo(self.color(piece, [u, v, w]), uv, plane.w * area),
            opacity: surface.opacity(uv),
        }
    }

    fn find(&self, ray: &Ray, seed: u32) -> Option<(Place, f32)> {
        let (piece, Meeting { v, w, distance }) = self.nearest(ray, seed)?;
        let u = 1.0 - v - w;
        let marked = self.firsts[piece];
        let is_back = self.planes[piece].truncate().dot(ray.direction) > 0.0;
        if is_back && marked & TWO_SIDED == 0 {
            return None;
        }
        let at = match marked & !TWO_SIDED {
            0 => Vec2::new(v, w),
            1 => Vec2::new(w, u),
            _ => Vec2::new(u, v),
        };
        Some((Place { piece: piece as u32, at, is_back }, distance))
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
