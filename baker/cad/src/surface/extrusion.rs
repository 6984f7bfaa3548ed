//! Surface of linear extrusion: σ(u, v) = λ(u) + v V.

use crate::curve::Curve;
use glam::{DVec2, DVec3};

/// Steps of the iteration.
const STEPS: usize = 60;

/// The point, σᵤ and σᵥ.
pub(super) fn derivatives(profile: &Curve, along: DVec3, at: DVec2) -> [DVec3; 3] {
    let [point, tangent] = profile.derivatives(at.x);
    [point + at.y * along, tangent, along]
}

/// Parameters of the point nearest to a place: by turns the height along V and the profile's nearest point there, then Gauss
/// and Newton's iteration in u.
pub(super) fn invert(profile: &Curve, along: DVec3, place: DVec3, near: Option<DVec2>) -> DVec2 {
    let axis = along.normalize_or_zero();
    let across = |p: DVec3| p - p.dot(axis) * axis;
    let height = |u: f64| (place - profile.point(u)).dot(along) / along.length_squared();
    let distance = |u: f64| across(place - profile.point(u)).length_squared();
    let near_u = near.map(|near| near.x);
    let mut u = profile.invert(place - near.map_or(0.0, |near| near.y) * along, near_u);
    let mut best = distance(u);
    for _ in 0..STEPS {
        let turned = profile.invert(place - height(u) * along, Some(u));
        let [at, tangent] = profile.derivatives(u);
        let flat = across(tangent);
        let step = u + across(place - at).dot(flat) / flat.length_squared();
        let reached = [turned, step].map(|u| (distance(u), u)).into_iter().filter(|(d, _)| *d < best);
        let Some((closer, next)) = reached.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        (best, u) = (closer, next);
    }
    DVec2::new(u, height(u))
}

/// Periods of u and v.
pub(super) fn periods(profile: &Curve, _along: DVec3) -> [Option<f64>; 2] {
    [profile.period(), None]
}

/// A box that holds a patch.
pub(super) fn bounds(profile: &Curve, along: DVec3, patch: [DVec2; 2]) -> [DVec3; 2] {
    let (hull, beyond) = profile.hull([patch[0].x, patch[1].x]);
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for place in hull.iter().flat_map(|place| [patch[0].y, patch[1].y].map(|v| *place + v * along)) {
        (low, high) = (low.min(place), high.max(place));
    }
    [low - beyond, high + beyond]
}
