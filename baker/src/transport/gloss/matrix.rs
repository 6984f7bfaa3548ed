//! The transfer matrix of a point, by rays: for directions ω of equal solid angle Ω over the point,
//!
//! ```text
//! T_ij = Ω Σ (y_i(ω) + y_i(ω')) (V(ω) y_j(ω) + (1 − V(ω)) ρ/π E_j(ω)),   V_i = Ω Σ (y_i(ω) + y_i(ω')) V(ω)
//! ```
//!
//! with ω mirrored at the tangent plane as ω', V whether the environment is seen, and ρ and E_j the reflectance and the
//! irradiance by function j where a ray ends. All points have the same directions, spherical Fibonacci points: neighbours err
//! alike, so that differences of their matrices are light and not noise.

use super::GlossSettings;
use super::sky_irradiance::SkyIrradiance;
use crate::geometry::{Ray, Surfaces};
use crate::random::mix;
use crate::sampling::Points;
use glam::Vec3;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::harmonics::{COUNT, evaluate};
use std::f32::consts::TAU;

/// Entries of a matrix vector: three channels, and visibility.
pub(super) const DIMENSIONS: usize = 3 * COUNT * COUNT + COUNT;

/// The matrices of red, green and blue by rows, then the coefficients of visibility.
pub(super) type MatrixVector = Box<[f32; DIMENSIONS]>;

/// Computes matrices.
pub(super) struct MatrixGather<'a, S: ?Sized> {
    surfaces: &'a S,
    points: &'a Points,
    irradiance: SkyIrradiance,
    /// Whether matrices hold light that did not bounce.
    has_direct: bool,
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

/// A direction mirrored at a plane.
fn mirrored(direction: Vec3, normal: Vec3) -> Vec3 {
    direction - 2.0 * direction.dot(normal) * normal
}

impl<'a, S: Surfaces + ?Sized> MatrixGather<'a, S> {
    /// Prepares the directions.
    pub fn new(
        surfaces: &'a S,
        points: &'a Points,
        irradiance: SkyIrradiance,
        settings: &GlossSettings,
    ) -> Self {
        let directions = fibonacci_sphere(settings.directions).map(|way| (way, evaluate(way))).collect();
        Self { surfaces, points, irradiance, has_direct: settings.has_direct, directions }
    }

    /// Returns the matrix of a point, and the number of rays.
    pub fn matrix(&self, point: usize) -> (MatrixVector, u64) {
        let at = &self.points.points[point];
        let origin = at.position + at.geometric_normal * self.surfaces.epsilon_at(at.position);
        let (mut out, mut rays) = (Box::new([0.0; DIMENSIONS]), 0);
        let mut open = [[0.0; COUNT]; COUNT];
        let (mut visibility, mut all) = ([0.0; COUNT], [0.0; COUNT]);
        let solid_angle = 2.0 * TAU / self.directions.len() as f32;
        let mut weights = Vec::new();
        for (number, (direction, y)) in self.directions.iter().enumerate() {
            if direction.dot(at.normal) <= 0.0 {
                continue;
            }
            let below = evaluate(mirrored(*direction, at.normal));
            let received: [f32; COUNT] = std::array::from_fn(|i| solid_angle * (y[i] + below[i]));
            all.iter_mut().zip(received).for_each(|(sum, r)| *sum += r);
            rays += 1;
            // Below the true surface a ray meets what the point is on; without it, smooth things have dark rims.
            let direction = match direction.dot(at.geometric_normal) > 0.0 {
                true => *direction,
                false => mirrored(*direction, at.geometric_normal),
            };
            let ray = Ray { origin, direction, max_distance: f32::INFINITY, spread: 0.02 };
            let seed = mix(number as u64) as u32;
            let Some(hit) = self.surfaces.cast(&ray, seed) else {
                for ((row, sum), r) in open.iter_mut().zip(&mut visibility).zip(received) {
                    row.iter_mut().zip(y).for_each(|(entry, y)| *entry += r * y);
                    *sum += r;
                }
                continue;
            };
            let sent = self.irradiance.radiance(&hit, &mut weights);
            for (i, r) in received.iter().enumerate() {
                for (j, sent) in sent.iter().enumerate() {
                    let light = *sent * *r;
                    out[i * COUNT + j] += light.x;
                    out[(COUNT + i) * COUNT + j] += light.y;
                    out[(2 * COUNT + i) * COUNT + j] += light.z;
                }
            }
        }
        if self.has_direct {
            for channel in out[..3 * COUNT * COUNT].chunks_exact_mut(COUNT * COUNT) {
                channel.iter_mut().zip(open.as_flattened()).for_each(|(entry, open)| *entry += open);
            }
        }
        // A control variate: directions are not as evenly spread above a plane as over the sphere, where an open point sees 1.
        let share = visibility[0] / all[0];
        for (i, (v, all)) in visibility.iter_mut().zip(all).enumerate() {
            *v += share * (if i == 0 { (2.0 * TAU).sqrt() } else { 0.0 } - all);
        }
        out[3 * COUNT * COUNT..].copy_from_slice(&visibility);
        (out, rays)
    }
}

#[cfg(test)]
mod tests;
