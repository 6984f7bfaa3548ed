//! Cone, in its own coordinates: σ(u, v) = ((R + v tan φ) cos u, (R + v tan φ) sin u, v).
//!
//! Both nappes belong to it. Beyond the apex, v < −R / tan φ, the radius R + v tan φ is negative: a place there has the u of the
//! generator that goes through the apex to it, half a turn from its own direction.

use super::angle::{sinusoid_range, turn_about_axis};
use super::local_ray::LocalRay;
use super::polynomial::{Roots, quadratic};
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;

/// Point, σᵤ, σᵥ; `slope` is tan φ.
pub(super) fn derivatives(radius: f64, slope: f64, at: DVec2) -> [DVec3; 3] {
    let (sin, cos) = at.x.sine_cosine();
    let out = DVec3::new(cos, sin, 0.0);
    let here = radius + at.y * slope;
    [here * out + at.y * DVec3::Z, here * DVec3::new(-sin, cos, 0.0), slope * out + DVec3::Z]
}

/// Unit σᵤ × σᵥ; at the apex that of the nappe of positive radius.
pub(super) fn normal(radius: f64, slope: f64, at: DVec2) -> DVec3 {
    let (sin, cos) = at.x.sine_cosine();
    let side = if radius + at.y * slope < 0.0 { -1.0 } else { 1.0 };
    DVec3::new(cos, sin, -slope) * (side / 1f64.hypotenuse(slope))
}

/// Parameters of the nearest point; on the axis u is that of `near`.
pub(super) fn invert(radius: f64, slope: f64, place: DVec3, near: Option<DVec2>) -> DVec2 {
    // In the plane through the axis and the place, beyond the apex on the side where the radius is negative.
    let side = if radius + slope * place.z < 0.0 { -1.0 } else { 1.0 };
    let u = turn_about_axis(DVec3::new(side * place.x, side * place.y, place.z), radius, near);
    let along = side * place.truncate().length();
    // Foot of the perpendicular to the generator.
    DVec2::new(u, ((along - radius) * slope + place.z) / (1.0 + slope * slope))
}

/// Where a line meets x² + y² = (R + z tan φ)². Along the line the radius is s₀ + s₁ s and the place in the plane o + d s. The
/// discriminant of the quadratic is |s₀ d − s₁ o|² − (o × d)², by Lagrange's identity; both squares are computed without cancellation.
pub(super) fn roots(radius: f64, slope: f64, ray: &LocalRay) -> Roots {
    let [o, d] = [ray.origin.truncate(), ray.direction.truncate()];
    let [s0, s1] = [radius + slope * ray.origin.z, slope * ray.direction.z];
    let [from_axis, sine] = [o.length(), d.length()];
    let widening = (s0 * d - s1 * o).length();
    let moment = o.perp_dot(d).abs();
    quadratic(
        (sine - s1) * (sine + s1),
        o.dot(d) - s0 * s1,
        (from_axis - s0) * (from_axis + s0),
        (widening - moment) * (widening + moment),
    )
}

/// How far a patch reaches along a direction: along a generator farthest at its ends.
pub(super) fn extent(radius: f64, slope: f64, direction: DVec3, [low, high]: [DVec2; 2]) -> [f64; 2] {
    let across = sinusoid_range(direction.x, direction.y, [low.x, high.x]);
    let mut extent = [f64::INFINITY, f64::NEG_INFINITY];
    for v in [low.y, high.y] {
        for across in across {
            let reach = (radius + slope * v) * across + direction.z * v;
            extent = [extent[0].min(reach), extent[1].max(reach)];
        }
    }
    extent
}

/// Area of a patch.
pub(super) fn area(radius: f64, slope: f64, [low, high]: [DVec2; 2]) -> f64 {
    let [from, to] = [radius + slope * low.y, radius + slope * high.y];
    let mean_times_height = if from * to >= 0.0 {
        0.5 * (from + to).abs() * (high.y - low.y)
    } else {
        0.5 * (from * from + to * to) / slope
    };
    (high.x - low.x) * mean_times_height * 1f64.hypotenuse(slope)
}
