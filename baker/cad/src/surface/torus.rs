//! Torus, in its own coordinates: σ(u, v) = ((R + r cos v) cos u, (R + r cos v) sin u, r sin v).
//!
//! Where R < r the circle crosses the axis, at v = ±arccos(−R / r). The outer part is what it sweeps with R + r cos v ≥ 0.

use super::angle::{first_turn, near_angle, sinusoid_range, turn_about_axis};
use super::local_ray::LocalRay;
use super::polynomial::{Roots, depressed_cubic, root_between};
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::TAU;

/// By how much the box about the torus is wider than it, a fraction of R + r: its ends are outside whatever rounding does.
const MARGIN: f64 = 1e-9;

/// How far outside of the distances asked for a root is still found, a fraction of R + r.
const BEYOND: f64 = 1e-6;

/// Error of roots, a fraction of R + r: Newton's iteration does not come nearer in rounded numbers.
const TOLERANCE: f64 = 1e-15;

/// Point, σᵤ, σᵥ.
pub(super) fn derivatives(major: f64, minor: f64, at: DVec2) -> [DVec3; 3] {
    let (sin_u, cos_u) = at.x.sine_cosine();
    let (sin_v, cos_v) = at.y.sine_cosine();
    let out = DVec3::new(cos_u, sin_u, 0.0);
    let radius = major + minor * cos_v;
    [
        radius * out + minor * sin_v * DVec3::Z,
        radius * DVec3::new(-sin_u, cos_u, 0.0),
        minor * (cos_v * DVec3::Z - sin_v * out),
    ]
}

/// Outward unit normal of the outer part, also where it has a pole.
pub(super) fn normal(at: DVec2) -> DVec3 {
    derivatives(0.0, 1.0, at)[0]
}

/// Parameters of the nearest point of the outer part. On the axis u is that of `near`; on the circle of the centres v is.
pub(super) fn invert(major: f64, minor: f64, place: DVec3, near: Option<DVec2>) -> DVec2 {
    let u = turn_about_axis(place, major + minor, near);
    let from_circle = DVec2::new(place.truncate().length() - major, place.z);
    let v = match near {
        Some(near) if from_circle.length() <= 1e-12 * (major + minor) => near.y,
        _ => from_circle.y.arc_tangent2(from_circle.x),
    };
    if major < minor {
        let pole = (-major / minor).arc_cosine();
        return DVec2::new(u, near_angle(v, 0.0).clamp(-pole, pole));
    }
    DVec2::new(u, first_turn(v))
}

/// Where a line meets the outer part.
///
/// The distance from the torus, √((ρ − R)² + z²) − r with ρ² = x² + y², has a root where the quartic
/// (x² + y² + z² + R² − r²)² − 4 R² (x² + y²) has one. Between the places where the quartic's slope is 0, a cubic's roots, it has at
/// most one. There the distance is looked at for a change of sign, and its root sought: near a double root and for a thin torus
/// (r ≪ R) it keeps the digits that the quartic's coefficients lose. A pair of roots is lost only where the line is within
/// about 1e-15 (R + r) of touching, besides the rounding of the ray's own coordinates.
///
/// Roots farther than [`BEYOND`] outside of these distances may be left out.
pub(super) fn roots(major: f64, minor: f64, ray: &LocalRay, distances: [f64; 2]) -> Roots {
    let mut roots = Roots::default();
    let size = major + minor;
    let [major, minor] = [major / size, minor / size];
    let [o, d] = [ray.origin / size, ray.direction];
    let Some(mut span) = box_span(minor, o, d) else { return roots };
    let [first, last] = distances.map(|distance| ray.length_at(distance) / size);
    span = [span[0].max(first - BEYOND), span[1].min(last + BEYOND)];
    if span[0] >= span[1] {
        return roots;
    }
    // A quarter of the quartic's slope, s³ + p s + q: o is nearest to the centre, o · d = 0.
    let p =
        o.length_squared() + major * major - minor * minor - 2.0 * major * major * (d.x * d.x + d.y * d.y);
    let q = -2.0 * major * major * (o.x * d.x + o.y * d.y);
    let distance = |s: f64| {
        let place = o + s * d;
        let from_axis = (place.x * place.x + place.y * place.y).sqrt();
        let beyond = from_axis - major;
        let from_circle = (beyond * beyond + place.z * place.z).sqrt();
        let outward = (place.x * d.x + place.y * d.y) / from_axis;
        (from_circle - minor, (beyond * outward + place.z * d.z) / from_circle)
    };
    let turns = depressed_cubic(p, q, span, 1e-13);
    let mut from = span[0];
    for to in turns.iter().copied().chain([span[1]]) {
        if let Some(root) = root_between(distance, [from, to], TOLERANCE) {
            roots.push(size * root);
        }
        from = to;
    }
    roots
}

/// The part of a line in the box about a torus with R + r = 1, `None` if it misses it.
fn box_span(minor: f64, o: DVec3, d: DVec3) -> Option<[f64; 2]> {
    let mut span = [f64::NEG_INFINITY, f64::INFINITY];
    for (half, o, d) in [(1.0, o.x, d.x), (1.0, o.y, d.y), (minor, o.z, d.z)] {
        let half = half + MARGIN;
        if d.abs() > 1e-12 {
            let [a, b] = [(-half - o) / d, (half - o) / d];
            span = [span[0].max(a.min(b)), span[1].min(a.max(b))];
        } else if o.abs() > half {
            return None;
        }
    }
    (span[0] < span[1]).then_some(span)
}

/// How far a patch reaches along a direction: for each v at an end of what the circle of u does.
pub(super) fn extent(major: f64, minor: f64, direction: DVec3, [low, high]: [DVec2; 2]) -> [f64; 2] {
    let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
    for across in sinusoid_range(direction.x, direction.y, [low.x, high.x]) {
        let [least, greatest] = sinusoid_range(across, direction.z, [low.y, high.y]);
        extent[0] = extent[0].min(major * across + minor * least);
        extent[1] = extent[1].max(major * across + minor * greatest);
    }
    extent
}

/// Area of the outer part of a patch that has at most a turn of v.
pub(super) fn area(major: f64, minor: f64, [low, high]: [DVec2; 2]) -> f64 {
    let band = |from: f64, to: f64| {
        // sin b − sin a, without cancellation.
        let rise = 2.0 * (0.5 * (from + to)).cosine() * (0.5 * (to - from)).sine();
        if to > from { major * (to - from) + minor * rise } else { 0.0 }
    };
    let bands = if major < minor {
        // The outer part comes again with each turn.
        let pole = (-major / minor).arc_cosine();
        let first = TAU * ((low.y + pole) / TAU).floor();
        let part = |middle: f64| band(low.y.max(middle - pole), high.y.min(middle + pole));
        part(first) + part(first + TAU)
    } else {
        band(low.y, high.y)
    };
    (high.x - low.x) * minor * bands
}
