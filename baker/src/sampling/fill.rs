//! Filling the holes that dart throwing leaves.
//!
//! Candidates land where light goes, so surfaces that get little of it are left with gaps between
//! their points when a level ends. From each point thrown, tries go once around it: up, across, down
//! again, the way that light could go. Only next to points thrown, so that a plain without end does
//! not fill up.

use super::SurfacePoint;
use super::poisson_disk::DartBoard;
use crate::geometry::{Ray, Surfaces};
use crate::random::Stream;
use crate::watch::{Stopped, Watch};
use glam::Vec3;
use rayon::prelude::*;

/// Tries around each point to go across, along the surface.
const ACROSS: u32 = 24;
/// Tries to see another surface, across a concave edge.
const SIGHT: u32 = 12;
/// Height from which either is tried, over the disk radius.
const LIFT: f32 = 0.3;

/// Adds points to the `board` of this disk radius where a neighbour of one of its points is free and
/// `fits`. The same board and seed give the same points.
///
/// # Errors
/// [`Stopped`].
pub fn fill<S: Surfaces + ?Sized>(
    surfaces: &S,
    board: &mut DartBoard,
    disk_radius: f32,
    seed: u64,
    fits: impl Fn(&SurfacePoint) -> bool + Sync,
    watch: &dyn Watch,
) -> Result<(), Stopped> {
    let found: Vec<Vec<SurfacePoint>> = board
        .points()
        .par_iter()
        .enumerate()
        .map(|(i, point)| {
            watch.step(0)?;
            let mut stream = Stream::new(seed ^ 0x6669_6c6c, i as u64);
            let normal = point.geometric_normal;
            let above = point.position + normal * (LIFT * disk_radius);
            let floor = point.position + normal * surfaces.epsilon_at(point.position);
            if surfaces.transmittance(floor, above).element_sum() < 1.5 {
                return Ok(Vec::new());
            }
            let mut found: Vec<SurfacePoint> = (0..ACROSS)
                .filter_map(|_| across(surfaces, board, point, above, disk_radius, &mut stream))
                .collect();
            found.extend((0..SIGHT).filter_map(|_| {
                let direction = stream.sphere();
                let direction = if direction.dot(normal) < 0.0 { -direction } else { direction };
                cast(surfaces, above, direction, 2.0 * disk_radius, &mut stream)
            }));
            found.retain(|candidate| board.is_free(candidate) && fits(candidate));
            Ok(found)
        })
        .collect::<Result<_, Stopped>>()?;
    for candidate in found.into_iter().flatten() {
        if board.is_free(&candidate) {
            board.insert(candidate);
        }
    }
    Ok(())
}

/// A place from one to two disk radii away, if it looks free and the way there is.
fn across<S: Surfaces + ?Sized>(
    surfaces: &S,
    board: &DartBoard,
    point: &SurfacePoint,
    above: Vec3,
    disk_radius: f32,
    stream: &mut Stream,
) -> Option<SurfacePoint> {
    let normal = point.geometric_normal;
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let (sin, cos) = (stream.unit() * std::f32::consts::TAU).sin_cos();
    let distance = disk_radius * (1.0 + 3.0 * stream.unit()).sqrt();
    let offset = (tangent * cos + bitangent * sin) * distance;
    if !board.is_free(&SurfacePoint { position: point.position + offset, ..*point })
        || surfaces.transmittance(above, above + offset).element_sum() < 1.5
    {
        return None;
    }
    cast(surfaces, above + offset, -normal, 2.0 * LIFT * disk_radius, stream)
}

/// The reflecting surface that a ray meets.
fn cast<S: Surfaces + ?Sized>(
    surfaces: &S,
    origin: Vec3,
    direction: Vec3,
    max_distance: f32,
    stream: &mut Stream,
) -> Option<SurfacePoint> {
    let hit = surfaces
        .cast(&Ray { origin, direction, max_distance, spread: Ray::VISIBILITY }, stream.bits() as u32);
    hit.filter(|hit| hit.faces(direction)).map(|hit| SurfacePoint::at(&hit, surfaces))
}
