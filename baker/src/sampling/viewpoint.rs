//! Search for viewpoints inside the scene, without user input.
//!
//! Tries are scattered over the scene's bounds and off the surfaces. A good viewpoint sees reflecting sides of surfaces
//! all around: within a closed room every ray ends on a reflecting side; inside a wall or under the floor rays end on
//! backs; outside, the majority of rays leave the scene. No single score separates a furnished room, open to the sky,
//! from the closed hollow under the room's floor. Therefore the best viewpoint of every part of the scene serves:
//! particles start from the viewpoints in turn.
//!
//! Files often declare all surfaces two-sided, and within a hollow object every ray ends on a back; so backs count at
//! lamps only.

use super::particle::from_viewpoint;
use crate::geometry::{Ray, Surfaces};
use crate::random::Stream;
use glam::{IVec3, Vec3};
use rayon::prelude::*;
use std::collections::HashMap;

const TRIES: u64 = 2048;
const RAYS: u64 = 96;
/// Parts of the scene along each axis. The best try of each part enters the second round.
const PARTS: f32 = 4.0;
/// Minimum score of a part's best try over the best score of all tries.
const GOOD: f32 = 0.5;
/// Maximum number of viewpoints.
const MOST: usize = 16;

/// Sides of surfaces that count.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sides {
    Fronts,
    /// Fronts, and backs that reflect.
    Both,
}

/// Finds the best viewpoints among random tries and the positions of `lights`, local space, best first; empty if no try
/// sees the front of a surface, and no light a reflecting side.
pub fn find<S: Surfaces + ?Sized>(surfaces: &S, lights: &[Vec3], seed: u64) -> Vec<Vec3> {
    let (low, high) = surfaces.main_part();
    let extent = high - low;
    let mut tries: Vec<(f32, u64, Vec3)> = (0..TRIES)
        .into_par_iter()
        .filter_map(|i| {
            let mut stream = Stream::new(seed ^ 0x7669_6577, i);
            let mut point = low + extent * Vec3::new(stream.unit(), stream.unit(), stream.unit());
            if i % 2 == 1 {
                // Every second try is in the middle of a free stretch between two surfaces, so that small rooms in a
                // large scene are tried too.
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

/// Score of a viewpoint: the share of rays that end on a reflecting side, minus four times the share that end on a side
/// without reflection, squared, times the harmonic mean distance. So a room open to the sky beats the hollow of a wall
/// (closed but tight) and the outside (where the majority of rays leave).
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
