//! Viewpoints inside the scene, found without help.
//!
//! Points are scattered over the scene's bounds and off its surfaces. A good one sees the
//! reflecting sides of surfaces all around it: from within a closed room every ray ends on one;
//! inside a wall or under the floor rays end on backs; outside most rays leave the scene. No
//! single score tells a furnished room that is open to the sky from the closed hollow under its
//! floor, so the best of each part of the scene all serve: particles start from each in turn.
//!
//! Files often say of all surfaces that both of their sides reflect, and within an object that is hollow every ray ends
//! on a back; so backs count only where a lamp is.

use super::particle::from_viewpoint;
use crate::geometry::{Ray, Surfaces};
use crate::random::Stream;
use glam::{IVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

const TRIES: u64 = 2048;
const RAYS: u64 = 96;
/// Parts of the scene along each axis, each of which sends its best try to the second round.
const PARTS: f32 = 4.0;
/// A part's best try serves if its score is at least this share of the best of all.
const GOOD: f32 = 0.5;
/// Viewpoints at most.
const MOST: usize = 16;

/// Which sides of surfaces count.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sides {
    Fronts,
    /// Backs that reflect, too.
    Both,
}

/// The best of many tries and of the places of `lights`, local space, best first; none when no try sees the front of any
/// surface, and no light a reflecting side.
pub fn find<S: Surfaces + ?Sized>(surfaces: &S, lights: &[Vec3], seed: u64) -> Vec<Vec3> {
    let (low, high) = surfaces.main_part();
    let extent = high - low;
    let mut tries: Vec<(f32, u64, Vec3)> = (0..TRIES)
        .into_par_iter()
        .filter_map(|i| {
            let mut stream = Stream::new(seed ^ 0x7669_6577, i);
            let mut point = low + extent * Vec3::new(stream.unit(), stream.unit(), stream.unit());
            if i % 2 == 1 {
                // Half of them right in the middle of a free stretch between two surfaces, so
                // that small rooms in a large scene are tried too.
                let ray = Ray::visibility(point, stream.sphere());
                let hit = surfaces.cast(&ray, 0)?;
                let away = stream.cosine_hemisphere(hit.geometric_normal);
                let origin = hit.offset_origin(away, surfaces.epsilon_at(hit.position));
                let free = surfaces
                    .cast(&Ray::visibility(origin, away), 0)
                    .map_or(0.25 * extent.length(), |h| h.distance);
                point = origin + away * (0.5 * free);
            }
            let score = score(surfaces, point, Sides::Fronts, &mut stream);
            (score > 0.0).then_some((score, i, point))
        })
        .collect();
    tries.extend((TRIES..).zip(lights).filter_map(|(i, &light)| {
        let mut stream = Stream::new(seed ^ 0x7669_6577, i);
        let score = score(surfaces, light, Sides::Both, &mut stream);
        (score > 0.0).then_some((score, i, light))
    }));
    let part = |p: Vec3| ((p - low) / extent.max(Vec3::splat(f32::MIN_POSITIVE)) * PARTS).floor().as_ivec3();
    let better = |a: &(f32, u64, Vec3), b: &(f32, u64, Vec3)| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1));
    let mut best_of_part: HashMap<IVec3, (f32, u64, Vec3)> = HashMap::new();
    for entry in tries {
        let best = best_of_part.entry(part(entry.2)).or_insert(entry);
        if better(&entry, best).is_gt() {
            *best = entry;
        }
    }
    let mut best: Vec<_> = best_of_part.into_values().collect();
    best.sort_by(|a, b| better(b, a));
    let least = best.first().map_or(0.0, |b| b.0 * GOOD);
    best.iter().filter(|b| b.0 >= least).take(MOST).map(|b| b.2).collect()
}

/// How good a viewpoint is: the share of rays that end on a reflecting side, less those that end
/// on one that does not, squared, times the harmonic mean distance. So a room open to the sky beats the
/// hollow of a wall, which is closed but tight, and the outside, where most rays leave.
fn score<S: Surfaces + ?Sized>(surfaces: &S, point: Vec3, sides: Sides, stream: &mut Stream) -> f32 {
    let (low, high) = surfaces.main_part();
    let diagonal = (high - low).length();
    let (mut front, mut dark, mut inverse_distance) = (0.0, 0.0, 0.0);
    for _ in 0..RAYS {
        let ray = from_viewpoint(point, stream);
        let seed = stream.bits() as u32;
        let is_back = || {
            let place = surfaces.primitives().and_then(|primitives| primitives.find(&ray, seed));
            place.is_some_and(|(place, _)| place.is_back)
        };
        let Some(hit) = surfaces.cast(&ray, seed) else { continue };
        if !hit.faces(ray.direction) {
            dark += 1.0;
        } else if sides == Sides::Both || !is_back() {
            front += 1.0;
            inverse_distance += 1.0 / hit.distance.max(1e-6 * diagonal);
        }
    }
    if front == 0.0 {
        return 0.0;
    }
    let share = ((front - 4.0 * dark) / RAYS as f32).max(0.0);
    let free = (front / inverse_distance) / diagonal;
    if free < 0.002 {
        return 0.0;
    }
    share * share * free.min(0.25)
}
