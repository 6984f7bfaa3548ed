//! Clip planes: supports end at walls.
//!
//! The support of a function reaches through geometry within the support: a floor's function under a wall into the next
//! room, a cushion's function through the cloth above. The paper admits leaks of this kind (section 5.2). Here, rays
//! along the surface of each point find the obstacles around the point. If nearly all of the support behind an obstacle
//! is out of sight, the plane of the obstacle cuts the support off. So the weights themselves keep rooms apart –
//! weights of senders, of parents and in pictures alike.
//!
//! The baker has the planes of all points from here, and `radiosity` those of the points around a node that has moved.

use crate::elementary::Elementary;
use crate::kernel::SQUASH;
use crate::rbn::bulk::{Cut, MAX_CUTS};
use crate::surroundings::{SupportedPoint, SurroundingHit, Surroundings};
use glam::Vec3;

/// Rays along the surface.
const RAYS: usize = 24;
/// Places sampled along each ray, at equal areas.
const PLACES: usize = 8;
/// Height of the rays, over the support radius: lower obstacles cause no cut.
const LIFT: f32 = 0.08;
/// Maximum cosine between an obstacle's normal and the point's normal. Surfaces that turn up more are the point's own,
/// curved surface, unless [the own surface runs on](runs_on) behind the hit.
const STANDING: f32 = 0.35;
/// Distance behind a leaning surface, over the support radius, at which the point's own surface must be found to run
/// on, and minimum cosine between the normals there.
const BEHIND: f32 = 0.1;
const LEVEL: f32 = 0.98;
/// Depth of the plane behind a sheet, over the distance to the surface behind: sheets bend.
const BACK: f32 = 0.1;
/// Rays around a point in search of surfaces behind a sheet.
const BACK_RAYS: usize = 8;
/// Distance from the point at which a sheet is probed for bending, and minimum depth of a bend below the plane, both
/// over the support radius.
const BENT_AT: f32 = 0.5;
const FLAT: f32 = 0.02;
/// Minimum cosine between the normals of surfaces that share functions.
const TURNED: f32 = 0.5;
/// Minimum share of the places behind a plane that must be out of sight for a cut.
const HIDDEN: f32 = 0.75;
/// Minimum number of hidden places (of RAYS · PLACES) that a cut adds to the other cuts.
const LEAST_PLACES: usize = 4;
/// Distance of planes behind the surface, over the support radius.
const MARGIN: f32 = 2e-3;

/// Visibility along a point's surface.
struct Sight {
    /// Unit directions of the rays.
    directions: [Vec3; RAYS],
    /// Free length of each ray, over the support radius; infinite without an obstacle.
    free: [f32; RAYS],
}

impl Sight {
    fn places(&self) -> impl Iterator<Item = (Vec3, bool)> + '_ {
        self.directions.iter().zip(&self.free).flat_map(|(direction, free)| {
            (0..PLACES).map(move |k| {
                let distance = ((k as f32 + 0.5) / PLACES as f32).sqrt();
                (*direction * distance, distance > *free)
            })
        })
    }
}

/// Returns the clip planes of a point's support, at most [`MAX_CUTS`]. `seed` decides which rays pass through surfaces that let
/// light through.
pub fn clip_planes(surfaces: &(impl Surroundings + ?Sized), point: &SupportedPoint, seed: u32) -> Vec<Cut> {
    let SupportedPoint { normal, radius, epsilon, .. } = *point;
    let margin = MARGIN * radius + epsilon;
    let floor = point.position + point.geometric_normal * epsilon;
    let mut cuts = Vec::new();
    // Straight up, to the top of the support: a lid ends the support everywhere, its upper side included.
    let height = radius / (1.0 + SQUASH);
    let lid = surfaces.cast(floor, normal, height, seed);
    if let Some(lid) = &lid {
        cuts.push(Cut::new(normal, (lid.distance - margin).max(0.5 * lid.distance)));
    }
    if let Some(distance) = behind(surfaces, point, seed) {
        cuts.push(Cut::new(-normal, distance + margin));
    }
    let lift = (LIFT * radius).min(lid.map_or(f32::INFINITY, |lid| 0.5 * lid.distance));
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let mut sight = Sight { directions: [Vec3::ZERO; RAYS], free: [f32::INFINITY; RAYS] };
    let mut planes: Vec<(Vec3, f32)> = Vec::new();
    for k in 0..RAYS {
        let (sin, cos) = (k as f32 / RAYS as f32 * std::f32::consts::TAU).sine_cosine();
        let direction = tangent * cos + bitangent * sin;
        sight.directions[k] = direction;
        let origin = floor + normal * lift;
        let Some(hit) = surfaces.cast(origin, direction, radius, seed) else { continue };
        let facing = hit.geometric_normal * -hit.geometric_normal.dot(direction).signum();
        if facing.dot(normal) > STANDING && !runs_on(surfaces, point, (origin, direction), hit.distance, seed)
        {
            continue;
        }
        sight.free[k] = hit.distance / radius;
        let distance = (point.position - hit.position).dot(facing);
        let is_known = |(n, d): &(Vec3, f32)| n.dot(facing) > 0.99 && (d - distance).abs() < margin;
        if !planes.iter().any(is_known) {
            planes.push((facing, distance));
        }
    }
    // Greedy selection: the plane with the largest gain first.
    let mut left: Vec<(Vec3, bool)> = sight.places().collect();
    while cuts.len() < MAX_CUTS {
        let behind = |(facing, distance): &(Vec3, f32), place: Vec3| -place.dot(*facing) * radius > *distance;
        let gain = |plane: &(Vec3, f32)| {
            let (mut hidden, mut all) = (0, 0);
            for (_, is_hidden) in left.iter().filter(|(place, _)| behind(plane, *place)) {
                all += 1;
                hidden += *is_hidden as usize;
            }
            if hidden as f32 >= HIDDEN * all as f32 { hidden } else { 0 }
        };
        let best = planes.iter().map(|plane| (gain(plane), plane)).max_by_key(|(gain, _)| *gain);
        let Some((_, plane)) = best.filter(|(gain, _)| *gain >= LEAST_PLACES) else { break };
        cuts.push(Cut::new(-plane.0, plane.1.max(0.0) + margin));
        left.retain(|(place, _)| !behind(plane, *place));
    }
    cuts
}

/// Distance of the plane that ends a function behind the point's thin sheet, if the support reaches a second surface
/// with a similar normal behind the sheet. `None` for sheets that bend, and if the surface behind is turned too far to
/// share the function.
fn behind(surfaces: &(impl Surroundings + ?Sized), point: &SupportedPoint, seed: u32) -> Option<f32> {
    let SupportedPoint { normal, radius, epsilon, .. } = *point;
    let seen = |origin: Vec3, direction: Vec3, max_distance: f32| {
        let is_covered = |hit: &SurroundingHit| {
            let turned = hit.geometric_normal.dot(normal) * -hit.geometric_normal.dot(direction).signum();
            turned > TURNED && hit.faces
        };
        surfaces.cast(origin, direction, max_distance, seed).filter(is_covered).map(|hit| hit.distance)
    };
    let (height, lift) = (radius / (1.0 + SQUASH), LIFT * radius);
    let back = point.position - point.geometric_normal * epsilon;
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let directions = (0..BACK_RAYS).map(|k| {
        let (sin, cos) = (k as f32 / BACK_RAYS as f32 * std::f32::consts::TAU).sine_cosine();
        tangent * cos + bitangent * sin
    });
    let straight = seen(back, -normal, height);
    let beside = || directions.clone().any(|along| seen(back - normal * lift, along, radius).is_some());
    let depth = straight.filter(|depth| *depth > lift).map(|depth| BACK * depth);
    let depth = depth.or_else(|| (straight.is_some() || beside()).then_some(0.0))?;
    // The point's own surface below the plane must stay in the support.
    let bends = |along: Vec3| {
        let above = point.position + (along * BENT_AT * radius) + normal * lift;
        seen(above, -normal, lift + height).is_some_and(|down| down > lift + depth + FLAT * radius)
    };
    (!directions.clone().any(bends)).then_some(depth)
}

/// True if the point's surface runs on behind the hit of a ray along the surface: the fold of a curtain or a block
/// stands on the surface, at any inclination. Under a slope of the surface itself there is no surface.
fn runs_on(
    surfaces: &(impl Surroundings + ?Sized),
    point: &SupportedPoint,
    (origin, along): (Vec3, Vec3),
    distance: f32,
    seed: u32,
) -> bool {
    let lift = (origin - point.position).dot(point.normal);
    let origin = origin + along * (distance + BEHIND * point.radius);
    let below = surfaces.cast(origin, -point.normal, 2.0 * lift, seed);
    below.is_some_and(|hit| hit.geometric_normal.dot(point.normal) > LEVEL)
}
