//! Rays over the hemispheres of points. All points have the same directions, spherical Fibonacci points: neighbours err alike, so
//! that differences between them are light and not noise.
//!
//! The hemisphere is that of the shading normal. Below the true surface a ray would meet what the point is on, and smooth things
//! would have dark rims; it is mirrored at the true surface.

use crate::geometry::{Hit, Ray, Surfaces};
use crate::random::mix;
use crate::sampling::Points;
use glam::Vec3;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::harmonics::{COUNT, evaluate};
use std::f32::consts::TAU;

/// A ray of a point.
pub(super) struct PointRay<'a> {
    /// Direction that its light is taken to come from.
    pub direction: Vec3,
    /// Direction of the ray: the same, or mirrored at the true surface.
    pub way: Vec3,
    /// The functions at `direction`.
    pub y: &'a [f32; COUNT],
}

/// Casts the rays of points.
pub(super) struct PointRays<'a, S: ?Sized> {
    surfaces: &'a S,
    points: &'a Points,
    /// Directions over the sphere, with the functions there.
    directions: Vec<(Vec3, [f32; COUNT])>,
}

/// Directions of about equal solid angle (Swinbank and Purser 2006).
fn fibonacci_sphere(count: u32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |k| {
        let z = 1.0 - (2.0 * k as f32 + 1.0) / count as f32;
        let turn = f64::from(k) * 0.618_033_988_749_895;
        let (sin, cos) = ((turn - turn.floor()) as f32 * TAU).sine_cosine();
        let r = (1.0 - z * z).max(0.0).sqrt();
        Vec3::new(r * cos, r * sin, z)
    })
}

impl<'a, S: Surfaces + ?Sized> PointRays<'a, S> {
    /// Prepares so many directions over the sphere.
    pub fn new(surfaces: &'a S, points: &'a Points, directions: u32) -> Self {
        let directions = fibonacci_sphere(directions).map(|way| (way, evaluate(way))).collect();
        Self { surfaces, points, directions }
    }

    /// Solid angle of a ray.
    pub fn solid_angle(&self) -> f32 {
        2.0 * TAU / self.directions.len() as f32
    }

    /// The surfaces.
    pub fn surfaces(&self) -> &'a S {
        self.surfaces
    }

    /// The points.
    pub fn points(&self) -> &'a Points {
        self.points
    }

    /// Casts the rays of a point; calls `visit` with each and its hit. Returns their number.
    pub fn cast(&self, point: usize, mut visit: impl FnMut(PointRay<'_>, Option<Hit>)) -> u64 {
        let at = &self.points.points[point];
        let origin = at.position + at.geometric_normal * self.surfaces.epsilon_at(at.position);
        let mut rays = 0;
        for (number, (direction, y)) in self.directions.iter().enumerate() {
            if direction.dot(at.normal) <= 0.0 {
                continue;
            }
            rays += 1;
            let is_above = direction.dot(at.geometric_normal) > 0.0;
            let way = if is_above { *direction } else { direction.reflect(at.geometric_normal) };
            let ray = Ray { origin, direction: way, max_distance: f32::INFINITY, spread: 0.02 };
            let hit = self.surfaces.cast(&ray, mix(number as u64) as u32);
            visit(PointRay { direction: *direction, way, y }, hit);
        }
        rays
    }
}
