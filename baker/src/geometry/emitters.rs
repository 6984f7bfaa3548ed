//! Triangles that shine, by number, so that a path tracer can sample them.

use glam::Vec3;

/// What shines at a hit, for the density of sampling it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HitEmitter {
    /// Number of the triangle among the surfaces' [`Emitters`].
    Surface(u32),
    /// Number of the light among area lights: [`WithLights`](super::with_lights::WithLights).
    Light(u32),
}

/// A triangle that shines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EmissiveTriangle {
    /// Corners, local space.
    pub corners: [Vec3; 3],
    /// Whether the back shines too.
    pub is_two_sided: bool,
    /// Number of the material.
    pub material: u32,
    /// Linear RGB radiance, about its mean over the triangle.
    pub mean: Vec3,
}

/// The triangles that shine. Hits on them have a [`HitEmitter::Surface`].
pub trait Emitters: Sync {
    /// Returns the number of triangles.
    fn emitter_count(&self) -> usize;

    /// Returns a triangle, by number.
    fn emitter(&self, number: u32) -> EmissiveTriangle;

    /// Returns the linear RGB radiance toward the origin of a ray in `direction` that arrives at barycentric weights of
    /// the corners, times the share of such rays that the surface stops: the mean [`Hit::emission`](super::Hit).
    fn radiance(&self, number: u32, weights: [f32; 3], direction: Vec3) -> Vec3;
}

impl EmissiveTriangle {
    /// Returns a normal vector on the front; the length is twice the triangle's area.
    #[inline]
    pub fn front(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }
}
