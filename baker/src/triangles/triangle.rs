//! Ray against triangle without gaps (Woop, Benthin, Wald: *Watertight Ray/Triangle
//! Intersection*, JCGT 2013).
//!
//! The corners are sheared so that the ray becomes the z axis; what is left are signs of areas
//! in the plane, and those are exact. A ray through a shared edge or corner therefore always
//! hits one of the triangles around it: closed rooms are closed.

use glam::{DVec4, Vec3, Vec4, Vec4Swizzles};

/// A ray, sheared: see [`Corners::meet`].
#[derive(Clone, Copy, Debug)]
pub(super) struct ShearedRay {
    axes: [usize; 3],
    origin: [f32; 3],
    shear: [f32; 3],
}

impl ShearedRay {
    /// Prepares a ray; the direction must not be zero.
    #[inline]
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        let size = direction.abs();
        let z = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let axes = [(z + 1) % 3, (z + 2) % 3, z];
        let d = axes.map(|i| direction[i]);
        Self { axes, origin: axes.map(|i| origin[i]), shear: [d[0] / d[2], d[1] / d[2], 1.0 / d[2]] }
    }
}

/// The corners by axis: all x, all y, all z; the fourth components are zero. 48 bytes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corners([Vec4; 3]);

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Meeting {
    /// From the ray's origin, in units of its direction's length.
    pub distance: f32,
    /// Weight of the second corner.
    pub v: f32,
    /// Weight of the third corner.
    pub w: f32,
}

impl Meeting {
    /// Weights of all corners, which sum to 1.
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

    /// The corners.
    #[inline]
    pub fn positions(&self) -> [Vec3; 3] {
        let [x, y, z] = self.0;
        [Vec3::new(x.x, y.x, z.x), Vec3::new(x.y, y.y, z.y), Vec3::new(x.z, y.z, z.z)]
    }

    /// Across the triangle, and as long as twice its area.
    #[inline]
    pub fn spanned(&self) -> Vec3 {
        let [a, b, c] = self.positions();
        (b - a).cross(c - a)
    }

    /// The corner across from the longest side.
    #[inline]
    pub fn first(&self) -> usize {
        let [a, b, c] = self.positions();
        let sides = [b.distance_squared(c), c.distance_squared(a), a.distance_squared(b)];
        let longest = |best: usize, i: usize| if sides[i] > sides[best] { i } else { best };
        (1..3).fold(0, longest)
    }

    /// The meeting with a ray at a distance from 0 up to and including `limit`.
    #[inline(always)]
    pub fn meet(&self, ray: &ShearedRay, limit: f32) -> Option<Meeting> {
        let along = |i: usize| self.0[ray.axes[i]] - ray.origin[i];
        let z = along(2);
        let x = along(0) - ray.shear[0] * z;
        let y = along(1) - ray.shear[1] * z;
        // Twice the signed areas of the triangles that the z axis makes with each edge: the
        // weights of a, b and c, up to a factor. A rounded difference of rounded products has
        // the wrong sign never, but may be zero where the exact one is not.
        let mut areas = x.zxyw() * y.yzxw() - y.zxyw() * x.yzxw();
        if areas.cmpeq(Vec4::ZERO).bitmask() & 7 == 0 {
            // All of one sign, or beside the triangle.
            if !matches!(areas.is_negative_bitmask() & 7, 0 | 7) {
                return None;
            }
        } else {
            areas = exact_areas(x, y)?;
        }
        let sum = areas.x + areas.y + areas.z;
        let scale = 1.0 / sum;
        let distance = areas.dot(z) * scale * ray.shear[2];
        // Also false for the NaN of a ray within the plane.
        if !(distance >= 0.0 && distance <= limit) {
            return None;
        }
        Some(Meeting { distance, v: areas.y * scale, w: areas.z * scale })
    }
}

/// The same areas by products that are exact; `None` where the ray is beside the triangle.
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
