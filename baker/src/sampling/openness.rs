//! Openness of points, by short rays over the hemisphere (see [`rebounce_shared::openness`]).

use super::Points;
use crate::geometry::{Ray, Surfaces};
use crate::job::watch::{Stopped, Watch};
use crate::random::Stream;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::openness::{REACH, open, stored};
use std::f32::consts::TAU;

/// Rows and columns of the stratification grid of a round of rays.
const SIDE: u32 = 4;
/// Rounds of a point whose first round met a surface.
const ROUNDS: u32 = 4;
/// Points between two calls of the watch: a few milliseconds.
const ASKED: usize = 256;
/// Seed of the rays, different from other seeds.
const SEED: u64 = 0x6f70_656e;

/// Computes the openness of each point within the reach of the finest level. Deterministic.
/// No unit of `watch` is counted.
///
/// # Errors
/// [`Stopped`].
pub fn openness<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &mut Points,
    watch: &dyn Watch,
) -> Result<(), Stopped> {
    let reach = REACH * points.levels.last().map_or(0.0, |level| level.support_radius);
    let found = points.points.par_iter().enumerate().map(|(i, point)| {
        if i % ASKED == 0 {
            watch.step(0)?;
        }
        let normals = [point.normal, point.geometric_normal];
        let round = |round: u32| {
            let mut stream = Stream::new(SEED + round as u64, i as u64);
            open_share(surfaces, point.position, normals, reach, SIDE, &mut stream)
        };
        let first = round(0);
        // Usually the first round meets no surface.
        let all =
            if first < 1.0 { (1..ROUNDS).fold(first, |sum, r| sum + round(r)) / ROUNDS as f32 } else { 1.0 };
        Ok(stored(all))
    });
    points.openness = found.collect::<Result<_, Stopped>>()?;
    Ok(())
}

/// Single estimate of the openness of a place with unit shading normal and unit true normal: `side`² rays,
/// cosine-distributed and stratified.
pub fn open_share<S: Surfaces + ?Sized>(
    surfaces: &S,
    position: Vec3,
    [normal, geometric]: [Vec3; 2],
    reach: f32,
    side: u32,
    stream: &mut Stream,
) -> f32 {
    let origin = position + geometric * surfaces.epsilon_at(position);
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let mut sum = 0.0;
    for cell in 0..side * side {
        let at = (Vec2::new((cell % side) as f32, (cell / side) as f32) + stream.square()) / side as f32;
        let seed = stream.bits() as u32;
        let (sin, cos) = (TAU * at.y).sine_cosine();
        let direction =
            (tangent * cos + bitangent * sin) * at.x.sqrt() + normal * (1.0 - at.x).max(0.0).sqrt();
        // A shading normal lets a few directions point into the surface.
        if direction.dot(geometric) <= 0.0 {
            continue;
        }
        let ray = Ray { origin, direction, max_distance: reach, spread: Ray::VISIBILITY };
        sum += surfaces.cast(&ray, seed).map_or(1.0, |hit| open(hit.distance / reach));
    }
    sum / (side * side) as f32
}
