//! Places of cube maps: spread over the metals of a file, and moved off them.

use crate::geometry::{Ray, Surfaces};
use glam::Vec3;
use rebounce_shared::baked::BakedScene;

/// Most of the way from a metal to what is over it.
const BETWEEN: f32 = 0.5;

/// Returns `count` places over metals, or fewer where there are fewer points: each is the farthest from those before it
/// (González 1985), moved along the normal by `lift` of the metals' size.
pub(super) fn places<S: Surfaces + ?Sized>(
    scene: &BakedScene,
    surfaces: &S,
    count: usize,
    lift: f32,
) -> Vec<Vec3> {
    let metals: Vec<(Vec3, Vec3)> = scene
        .gloss
        .points
        .iter()
        .map(|point| &scene.points[*point as usize])
        .map(|point| (point.position(), point.normal()))
        .filter(|(position, normal)| is_metal(surfaces, *position, *normal))
        .collect();
    let (low, high) = metals
        .iter()
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), (at, _)| (low.min(*at), high.max(*at)));
    let lift = lift * (high - low).length();
    let lifted: Vec<Vec3> = metals.iter().map(|(at, normal)| lifted(surfaces, *at, *normal, lift)).collect();
    spread(&lifted, count)
}

/// Whether the surface at a point is a metal.
fn is_metal(surfaces: &(impl Surfaces + ?Sized), position: Vec3, normal: Vec3) -> bool {
    let near = 8.0 * surfaces.epsilon_at(position);
    let ray = Ray { max_distance: 2.0 * near, ..Ray::visibility(position + near * normal, -normal) };
    surfaces.cast(&ray, 0).is_some_and(|hit| hit.gloss.is_metal())
}

/// A place over a point, not beyond what is over it.
fn lifted(surfaces: &(impl Surfaces + ?Sized), position: Vec3, normal: Vec3, lift: f32) -> Vec3 {
    let ray = Ray::visibility(position + 2.0 * surfaces.epsilon_at(position) * normal, normal);
    let free = surfaces.cast(&ray, 0).map_or(f32::INFINITY, |hit| hit.distance);
    position + normal * lift.min(BETWEEN * free)
}

/// Chooses places far from each other, beginning with that nearest the middle of all.
fn spread(places: &[Vec3], count: usize) -> Vec<Vec3> {
    let mean = places.iter().sum::<Vec3>() / places.len().max(1) as f32;
    let nearest = |a: &&Vec3, b: &&Vec3| a.distance_squared(mean).total_cmp(&b.distance_squared(mean));
    let Some(first) = places.iter().min_by(nearest) else { return Vec::new() };
    let mut chosen = vec![*first];
    let mut distances: Vec<f32> = places.iter().map(|place| place.distance_squared(*first)).collect();
    while chosen.len() < count {
        let farthest = distances.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        let Some((next, _)) = farthest.filter(|(_, distance)| **distance > 0.0) else { break };
        let next = places[next];
        chosen.push(next);
        for (distance, place) in distances.iter_mut().zip(places) {
            *distance = distance.min(place.distance_squared(next));
        }
    }
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chosen_places_cover_the_others_and_none_is_chosen_twice() {
        let line: Vec<Vec3> = (0..101).map(|i| Vec3::X * i as f32).collect();
        assert_eq!(spread(&line, 3), [50.0, 100.0, 0.0].map(|x| Vec3::X * x));
        let five = spread(&line, 5);
        assert!(line.iter().all(|at| five.iter().any(|place| place.distance(*at) <= 13.0)));
        assert_eq!(spread(&line[..2], 8).len(), 2);
        assert!(spread(&[], 8).is_empty());
    }
}
