//! Emissive triangles of surfaces, for explicit light sampling (next-event estimation).

use glam::{Vec2, Vec3};

/// A triangle that emits light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emitter {
    /// Corners, local space, counter-clockwise seen from the front.
    pub corners: [Vec3; 3],
    /// Whether the back emits too.
    pub is_two_sided: bool,
    /// Index of the material.
    pub material: u32,
    /// Mean emitted radiance, linear RGB.
    pub radiance: Vec3,
}

/// Surfaces with emissive triangles.
pub trait Emitters: Sync {
    /// Returns the number of emissive triangles.
    fn emitter_count(&self) -> usize;

    /// Returns an emissive triangle, by number.
    fn emitter(&self, number: usize) -> Emitter;

    /// Returns the radiance emitted at a position of a triangle, linear RGB, regardless of the side; averaged over about
    /// this `area`, square scene units. `at`: barycentric weights of the second and third corner.
    fn radiance(&self, number: usize, at: Vec2, area: f32) -> Vec3;
}

impl Emitter {
    /// Returns a normal vector on the front; the length is twice the triangle's area.
    #[inline]
    pub fn front(&self) -> Vec3 {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a)
    }

    /// Returns whether the triangle emits light to a position: on the front, or two-sided.
    #[inline]
    pub fn faces(&self, position: Vec3) -> bool {
        self.is_two_sided || self.front().dot(position - self.corners[0]) > 0.0
    }
}
