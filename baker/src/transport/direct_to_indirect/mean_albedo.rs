//! Mean albedo of a scene: the share of light that surfaces reflect to other surfaces. ε is
//! relative to the mean albedo.

use crate::geometry::{Ray, Surfaces};
use crate::random::Stream;
use crate::sampling::Points;
use rayon::prelude::*;

/// Number of sampled points, starting with the coarsest.
const POINTS: usize = 1024;
/// Rays per sampled point.
const RAYS: u64 = 64;
/// Least mean albedo, so that a black scene has a positive ε.
const LEAST: f32 = 0.02;

/// Returns the mean irradiance at the points from surfaces of unit irradiance, 0.02 to 1: the
/// scene's mean albedo, with a black sky. Points of the `coarsest` levels are skipped, because
/// these levels cover distant surroundings.
pub fn reflected_share<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &Points,
    coarsest: usize,
    seed: u64,
) -> f32 {
    let some = &points.points[points.count_on(coarsest)..];
    let some = &some[..some.len().min(POINTS)];
    let sums: Vec<f32> = (0u64..)
        .zip(some)
        .collect::<Vec<_>>()
        .into_par_iter()
        .map(|(i, point)| {
            let mut stream = Stream::new(seed ^ 0x7265_666c, i);
            let origin = point.position + point.geometric_normal * surfaces.epsilon_at(point.position);
            let mut sum = 0.0;
            for _ in 0..RAYS {
                let direction = stream.cosine_hemisphere(point.normal);
                let seed = stream.bits() as u32;
                if direction.dot(point.geometric_normal) > 0.0
                    && let Some(hit) = surfaces
                        .cast(&Ray { origin, direction, max_distance: f32::INFINITY, spread: 0.0 }, seed)
                    && hit.faces(direction)
                {
                    sum += hit.albedo.element_sum() / 3.0;
                }
            }
            sum
        })
        .collect();
    (sums.iter().sum::<f32>() / (sums.len().max(1) as u64 * RAYS) as f32).clamp(LEAST, 1.0)
}
