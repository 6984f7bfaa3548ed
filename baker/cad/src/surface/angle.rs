//! Angles: periods, and the range of a sinusoid.

use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{PI, TAU};

/// Radians by which an angle may miss an interval: rounding of angles of some turns.
const ROUNDING: f64 = 1e-14;

/// The angle, by whole turns nearest to `near`.
pub(crate) fn near_angle(angle: f64, near: f64) -> f64 {
    angle + TAU * ((near - angle) / TAU).round()
}

/// The angle within 0 and 2π.
pub(crate) fn first_turn(angle: f64) -> f64 {
    if angle < 0.0 { angle + TAU } else { angle }
}

/// Angle of a place about the z axis, 0 to 2π. Within 1e-12 of the place's distance or the surface's size from the axis the angle is
/// that of `near`, if there is one.
pub(crate) fn turn_about_axis(place: DVec3, size: f64, near: Option<DVec2>) -> f64 {
    let from_axis = place.truncate().length();
    match near {
        Some(near) if from_axis <= 1e-12 * size.max(place.z.abs()) => near.x,
        _ => first_turn(place.y.arc_tangent2(place.x)),
    }
}

/// The angle brought by whole turns into [low, high]; `None` if no turn of it lies there. An angle that misses an end by
/// rounding is that end.
pub(crate) fn angle_within(angle: f64, [low, high]: [f64; 2]) -> Option<f64> {
    if low == f64::NEG_INFINITY {
        return Some(angle - TAU * ((angle - high) / TAU).ceil().max(0.0));
    }
    let turned = angle + TAU * ((low - ROUNDING - angle) / TAU).ceil();
    (turned <= high + ROUNDING).then(|| turned.max(low).min(high))
}

/// Least and greatest value of a cos t + b sin t for t in [low, high].
pub(crate) fn sinusoid_range(a: f64, b: f64, [low, high]: [f64; 2]) -> [f64; 2] {
    let amplitude = a.hypotenuse(b);
    let phase = b.arc_tangent2(a);
    let at = |t: f64| a * t.cosine() + b * t.sine();
    let [first, last] = [at(low), at(high)];
    // The first angle from `low` on that is `of` but for whole turns.
    let reaches = |of: f64| of + TAU * ((low - of) / TAU).ceil() <= high;
    let least = if reaches(phase + PI) { -amplitude } else { first.min(last) };
    let greatest = if reaches(phase) { amplitude } else { first.max(last) };
    [least, greatest]
}
