//! Filling of the gaps that dart throwing leaves.
//!
//! Candidates follow the light, so dark surfaces have gaps between points at the end of a level. Around each thrown
//! point, a single round of tries goes up, across and down again, along paths open to light. Tries start at thrown
//! points only, so that an endless plain does not fill up.

use super::SurfacePoint;
use super::poisson_disk::DartBoard;
use crate::geometry::{Ray, Surfaces};
use crate::job::watch::{Stopped, Watch};
use crate::random::Stream;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::elementary::Elementary;

/// Tries per point across the surface.
const ACROSS: u32 = 24;
/// Tries per point for a hit with another surface, across a concave edge.
const SIGHT: u32 = 12;
/// Height at which tries start, over the disk radius.
const LIFT: f32 = 0.3;

/// Adds points to the `board`, at tries around the board's points that are free and `fits`. The same board and seed add
/// the same points.
///
/// # Errors
/// [`Stopped`].
pub fn fill<S: Surfaces + ?Sized>(
    surfaces: &S,
    board: &mut DartBoard,
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
            let (normal, disk_radius) = (point.geometric_normal, board.radius(point.group));
            let above = point.position + normal * (LIFT * disk_radius);
            let floor = point.position + normal * surfaces.epsilon_at(point.position);
            if surfaces.transmittance(floor, above).element_sum() < 1.5 {
                return Ok(Vec::new());
            }
            let mut found: Vec<SurfacePoint> =
                (0..ACROSS).filter_map(|_| across(surfaces, board, point, above, &mut stream)).collect();
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

/// Tries a point one to two disk radii away; `None` if the place is not free or the way is blocked.
fn across<S: Surfaces + ?Sized>(
    surfaces: &S,
    board: &DartBoard,
    point: &SurfacePoint,
    above: Vec3,
    stream: &mut Stream,
) -> Option<SurfacePoint> {
    let (normal, disk_radius) = (point.geometric_normal, board.radius(point.group));
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let (sin, cos) = (stream.unit() * std::f32::consts::TAU).sine_cosine();
    let distance = disk_radius * (1.0 + 3.0 * stream.unit()).sqrt();
    let offset = (tangent * cos + bitangent * sin) * distance;
    if !board.is_free(&SurfacePoint { position: point.position + offset, ..*point })
        || surfaces.transmittance(above, above + offset).element_sum() < 1.5
    {
        return None;
    }
    cast(surfaces, above + offset, -normal, 2.0 * LIFT * disk_radius, stream)
}

/// Point at the nearest hit of a ray, if the side hit reflects.
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
