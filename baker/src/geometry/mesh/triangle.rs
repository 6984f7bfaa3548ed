//! Watertight ray/triangle test (Woop, Benthin, Wald: *Watertight Ray/Triangle Intersection*, JCGT 2013).
//!
//! The corners are sheared so that the ray becomes the z axis; the remaining test is of the signs of areas in the
//! plane, and the signs are exact. A ray through a shared edge or corner therefore always hits an adjacent triangle:
//! closed rooms are closed.

use crate::geometry::Ray;
use crate::lanes::{F32x8, LANES, Mask8};
use glam::{DVec4, Vec3, Vec4, Vec4Swizzles};

/// A ray, sheared: see [`Corners::meet`].
#[derive(Clone, Copy, Debug)]
pub(super) struct ShearedRay {
    pub axes: [usize; 3],
    pub origin: [f32; 3],
    pub shear: [f32; 3],
}

impl ShearedRay {
    /// Prepares a ray; the direction must not be zero.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let z = Ray::major_axis(direction);
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let d = axes.map(|i| direction[i]);
        Self { axes, origin: axes.map(|i| origin[i]), shear: [d[0] / d[2], d[1] / d[2], 1.0 / d[2]] }
    }
}

/// Eight sheared rays with a common major axis.
pub(super) struct ShearedRays<V> {
    axes: [usize; 3],
    origin: [V; 3],
    shear: [V; 3],
}

impl<V: F32x8> ShearedRays<V> {
    /// Combines eight [`ShearedRay`]s with equal `axes`.
    #[inline(always)]
    pub fn new(axes: [usize; 3], origin: [[f32; LANES]; 3], shear: [[f32; LANES]; 3]) -> Self {
        Self { axes, origin: bytemuck::cast(origin), shear: bytemuck::cast(shear) }
    }
}

/// Hits of eight rays with a triangle.
pub(super) struct TriangleHits {
    /// Bit mask of rays with a certain or possible hit.
    pub met: u32,
    /// Bit mask of rays with a possible hit: [`Corners::meet`] decides.
    pub unclear: u32,
    distance: [f32; LANES],
    v: [f32; LANES],
    w: [f32; LANES],
}

impl TriangleHits {
    /// Returns the hit of a ray with a certain hit.
    #[inline]
    pub fn of(&self, ray: usize) -> TriangleHit {
        TriangleHit { distance: self.distance[ray], v: self.v[ray], w: self.w[ray] }
    }
}

/// Corners by axis: x, y and z of the three corners; the fourth components are zero. 48 bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners([Vec4; 3]);

/// Hit of a ray with a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct TriangleHit {
    /// Distance from the ray's origin, in units of the direction's length.
    pub distance: f32,
    /// Weight of the second corner.
    pub v: f32,
    /// Weight of the third corner.
    pub w: f32,
}

impl TriangleHit {
    /// Returns the barycentric weights of the three corners; the sum is 1.
    #[inline]
    pub fn shares(&self) -> [f32; 3] {
        [1.0 - self.v - self.w, self.v, self.w]
    }
}

impl Corners {
    pub fn new(positions: [Vec3; 3]) -> Self {
        let [a, b, c] = positions;
        Self([Vec4::new(a.x, b.x, c.x, 0.0), Vec4::new(a.y, b.y, c.y, 0.0), Vec4::new(a.z, b.z, c.z, 0.0)])
    }

    /// Returns the corners.
    #[inline]
    pub fn positions(&self) -> [Vec3; 3] {
        let [x, y, z] = self.0;
        [Vec3::new(x.x, y.x, z.x), Vec3::new(x.y, y.y, z.y), Vec3::new(x.z, y.z, z.z)]
    }

    /// Returns a normal vector; the length is twice the triangle's area.
    #[inline]
    pub fn spanned(&self) -> Vec3 {
        let [a, b, c] = self.positions();
        (b - a).cross(c - a)
    }

    /// Returns the index of the corner opposite the longest side.
    #[inline]
    pub fn first(&self) -> usize {
        let [a, b, c] = self.positions();
        let sides = [b.distance_squared(c), c.distance_squared(a), a.distance_squared(b)];
        let longest = |best: usize, i: usize| if sides[i] > sides[best] { i } else { best };
        (1..3).fold(0, longest)
    }

    /// Returns the hit of a ray at a distance from 0 up to and including `limit`.
    #[inline(always)]
    pub fn meet(&self, ray: &ShearedRay, limit: f32) -> Option<TriangleHit> {
        let along = |i: usize| self.0[ray.axes[i]] - ray.origin[i];
        let z = along(2);
        let x = along(0) - ray.shear[0] * z;
        let y = along(1) - ray.shear[1] * z;
        // Twice the signed areas of the triangles between the z axis and the edges: the weights of a, b and c, up to a
        // factor. A rounded difference of rounded products never has the wrong sign, but may be zero where the exact
        // difference is not.
        let mut areas = x.zxyw() * y.yzxw() - y.zxyw() * x.yzxw();
        if areas.cmpeq(Vec4::ZERO).bitmask() & 7 == 0 {
            // Areas of equal sign, or the ray is beside the triangle.
            if !matches!(areas.is_negative_bitmask() & 7, 0 | 7) {
                return None;
            }
        } else {
            areas = exact_areas(x, y)?;
        }
        let sum = areas.x + areas.y + areas.z;
        let scale = 1.0 / sum;
        // Order of operations as for eight rays, for equal results.
        let parts = areas * z;
        let distance = ((parts.x + parts.z) + parts.y) * scale * ray.shear[2];
        // Also false for the NaN of a ray within the plane.
        if !(distance >= 0.0 && distance <= limit) {
            return None;
        }
        Some(TriangleHit { distance, v: areas.y * scale, w: areas.z * scale })
    }
}

impl Corners {
    /// [`Self::meet`] for the rays of the bit mask `rays`, by the same arithmetic in the same order.
    #[inline(always)]
    pub fn meet_together<V: F32x8>(
        &self,
        sheared: &ShearedRays<V>,
        limits: [f32; LANES],
        rays: u32,
    ) -> TriangleHits {
        let z = self.along(sheared, 2);
        let (x, y) = (self.across(sheared, 0, z), self.across(sheared, 1, z));
        let a = x[2] * y[1] - y[2] * x[1];
        let b = x[0] * y[2] - y[0] * x[2];
        let c = x[1] * y[0] - y[1] * x[0];
        // Beside the triangle where some areas are negative, but not all.
        let beside = (a & b & c).and_not(a | b | c).movemask();
        let zero = V::splat(0.0);
        let unclear = (a.eq(zero) | b.eq(zero) | c.eq(zero)).movemask() & rays;
        let within = rays & !beside;
        if within | unclear == 0 {
            return TriangleHits { met: 0, unclear: 0, distance: [0.0; 8], v: [0.0; 8], w: [0.0; 8] };
        }
        let scale = V::splat(1.0) / (a + b + c);
        let distance = (a * z[0] + c * z[2] + b * z[1]) * scale * sheared.shear[2];
        let is_near = distance.ge(zero) & distance.le(V::from_array(limits));
        TriangleHits {
            met: within & is_near.movemask() | unclear,
            unclear,
            distance: distance.to_array(),
            v: (b * scale).to_array(),
            w: (c * scale).to_array(),
        }
    }

    /// Returns the offsets of the corners from the rays' origins, along the axis `i` of the sheared rays.
    #[inline(always)]
    fn along<V: F32x8>(&self, sheared: &ShearedRays<V>, i: usize) -> [V; 3] {
        let corners = self.0[sheared.axes[i]];
        let origin = sheared.origin[i];
        [V::splat(corners.x) - origin, V::splat(corners.y) - origin, V::splat(corners.z) - origin]
    }

    /// Returns the sheared corners along the axis `i`; `z` are their offsets along the rays.
    #[inline(always)]
    fn across<V: F32x8>(&self, sheared: &ShearedRays<V>, i: usize, z: [V; 3]) -> [V; 3] {
        let along = self.along(sheared, i);
        let shear = sheared.shear[i];
        [along[0] - shear * z[0], along[1] - shear * z[1], along[2] - shear * z[2]]
    }
}

/// Returns the areas, from exact products; `None` if the ray is beside the triangle.
#[cold]
#[inline(never)]
fn exact_areas(x: Vec4, y: Vec4) -> Option<Vec4> {
    // Products of two f32 are exact in f64.
    let (x, y): (DVec4, DVec4) = (x.as_dvec4(), y.as_dvec4());
    let exact = |p: DVec4, q: DVec4| {
        DVec4::new(p.z * q.y, p.x * q.z, p.y * q.x, 0.0) - DVec4::new(q.z * p.y, q.x * p.z, q.y * p.x, 0.0)
    };
    let areas = exact(x, y).as_vec4();
    let negative = areas.cmplt(Vec4::ZERO).bitmask() & 7;
    let positive = areas.cmpgt(Vec4::ZERO).bitmask() & 7;
    (negative == 0 || positive == 0).then_some(areas)
}
