//! A viewpoint inside the scene, found without help.
//!
//! A good viewpoint sees the reflecting sides of surfaces all around it: from within a closed
//! room every ray ends on one; inside a wall or under the floor rays end on backs; outside most
//! rays leave the scene. Candidates are scattered over the scene's bounds and off its surfaces.

use crate::random::Stream;
use crate::surface::{Ray, Surfaces};
use glam::Vec3;
use rayon::prelude::*;

const TRIES: u64 = 2048;
const RAYS: u64 = 96;

/// The best of many tries; `None` when no try sees the reflecting side of any surface.
pub fn find<S: Surfaces + ?Sized>(surfaces: &S, seed: u64) -> Option<Vec3> {
    let (low, high) = surfaces.bounds();
    let extent = high - low;
    let best = (0..TRIES)
        .into_par_iter()
        .filter_map(|i| {
            let mut stream = Stream::new(seed ^ 0x7669_6577, i);
            let mut point = low + extent * Vec3::new(stream.unit(), stream.unit(), stream.unit());
            if i % 2 == 1 {
                // Half of them right in the middle of a free stretch between two surfaces, so
                // that small rooms in a large scene are tried too.
                let ray = Ray { origin: point, direction: stream.sphere(), max_distance: f32::INFINITY };
                let hit = surfaces.cast(&ray, 0)?;
                let away = stream.cosine_hemisphere(hit.geometric_normal);
                let origin = hit.offset_origin(away, surfaces.epsilon());
                let free = surfaces
                    .cast(&Ray { origin, direction: away, max_distance: f32::INFINITY }, 0)
                    .map_or(0.25 * extent.length(), |h| h.distance);
                point = origin + away * (0.5 * free);
            }
            let score = score(surfaces, point, &mut stream, extent.length());
            (score > 0.0).then_some((score, i, point))
        })
        .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
    best.map(|(_, _, point)| point)
}

/// How good a viewpoint is: the share of rays that end on a reflecting side, less those that end
/// on a back, times a gentle preference for open space.
fn score<S: Surfaces + ?Sized>(surfaces: &S, point: Vec3, stream: &mut Stream, diagonal: f32) -> f32 {
    let (mut front, mut back, mut inverse_distance) = (0.0, 0.0, 0.0);
    for _ in 0..RAYS {
        let ray = Ray { origin: point, direction: stream.sphere(), max_distance: f32::INFINITY };
        match surfaces.cast(&ray, stream.bits() as u32) {
            Some(hit) if hit.faces(ray.direction) => {
                front += 1.0;
                inverse_distance += 1.0 / hit.distance.max(1e-6 * diagonal);
            }
            Some(_) => back += 1.0,
            None => {}
        }
    }
    if front == 0.0 {
        return 0.0;
    }
    let share = ((front - 4.0 * back) / RAYS as f32).max(0.0);
    let free = (front / inverse_distance) / diagonal;
    share * share * free.powf(0.25)
}
