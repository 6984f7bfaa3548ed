//! Surface of revolution: σ(u, v) = λ(v) turned by u about the z axis of a frame.

use super::angle::{near_angle, turn_about_axis};
use crate::curve::Curve;
use crate::frame::Frame;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Samples of a profile that find the plane it lies in.
const SAMPLES: usize = 16;
/// Steps of Gauss and Newton's iteration.
const STEPS: usize = 30;

/// The point, σᵤ and σᵥ.
pub(super) fn derivatives(frame: &Frame, profile: &Curve, at: DVec2) -> [DVec3; 3] {
    let [point, along] = profile.derivatives(at.y);
    let (sine, cosine) = at.x.sin_cos();
    let turned = |p: DVec3| DVec3::new(cosine * p.x - sine * p.y, sine * p.x + cosine * p.y, p.z);
    let point = turned(frame.local(point));
    let along = turned(frame.local_direction(along));
    [frame.place(point), frame.turn(DVec3::new(-point.y, point.x, 0.0)), frame.turn(along)]
}

/// Parameters of the point nearest to a place.
pub(super) fn invert(frame: &Frame, profile: &Curve, place: DVec3, near: Option<DVec2>) -> DVec2 {
    let local = frame.local(place);
    let (radius, height) = (local.truncate().length(), local.z);
    // In the half plane of the place: distance from the axis, and height.
    let flat = |v: f64| {
        let [p, along] = profile.derivatives(v);
        let (p, along) = (frame.local(p), frame.local_direction(along));
        let from_axis = p.truncate().length();
        let outward = p.truncate().dot(along.truncate()) / from_axis.max(f64::MIN_POSITIVE);
        [DVec2::new(from_axis, p.z), DVec2::new(outward, along.z)]
    };
    let wanted = DVec2::new(radius, height);
    let distance = |v: f64| flat(v)[0].distance_squared(wanted);
    // The place turned into the profile's plane, on both sides of the axis.
    let [from, to] = profile.some_range();
    let widest = (0..=SAMPLES)
        .map(|k| frame.local(profile.point(from + (to - from) * k as f64 / SAMPLES as f64)))
        .max_by(|a, b| a.truncate().length_squared().total_cmp(&b.truncate().length_squared()));
    let outward = widest.and_then(|p| p.truncate().try_normalize()).unwrap_or(DVec2::X);
    let turned = |sign: f64| frame.place((sign * radius * outward).extend(height));
    let near_v = near.map(|near| near.y);
    let starts =
        [Some(profile.invert(turned(1.0), near_v)), Some(profile.invert(turned(-1.0), near_v)), near_v];
    let start = starts.into_iter().flatten().map(|v| (distance(v), v)).min_by(|a, b| a.0.total_cmp(&b.0));
    let (mut best, mut v) = start.unwrap_or_default();
    for _ in 0..STEPS {
        let [at, along] = flat(v);
        let mut step = (wanted - at).dot(along) / along.length_squared();
        while step.is_finite() && step.abs() > f64::EPSILON && distance(v + step) > best {
            step *= 0.5;
        }
        let reached = distance(v + step);
        if !(reached < best) {
            break;
        }
        (v, best) = (v + step, reached);
    }
    let of_profile = frame.local(profile.point(v));
    let turn = turn_about_axis(local, radius.max(height.abs()), near) - of_profile.y.atan2(of_profile.x);
    let is_on_axis = of_profile.truncate().length() <= 1e-12 * of_profile.length().max(radius);
    DVec2::new(
        match near {
            Some(near) if is_on_axis => near.x,
            Some(near) => near_angle(turn, near.x),
            None => turn.rem_euclid(TAU),
        },
        v,
    )
}

/// Periods of u and v.
pub(super) fn periods(_frame: &Frame, profile: &Curve) -> [Option<f64>; 2] {
    [Some(TAU), profile.period()]
}

/// A box that holds a patch, and the full turn of it.
pub(super) fn bounds(frame: &Frame, profile: &Curve, patch: [DVec2; 2]) -> [DVec3; 2] {
    let (hull, beyond) = profile.hull([patch[0].y, patch[1].y]);
    let (mut radius, mut low, mut high) = (0.0f64, f64::INFINITY, f64::NEG_INFINITY);
    for place in hull {
        let local = frame.local(place);
        radius = radius.max(local.truncate().length() + beyond);
        (low, high) = (low.min(local.z - beyond), high.max(local.z + beyond));
    }
    let across = |axis: f64| radius * (1.0 - axis * axis).max(0.0).sqrt();
    let wide = DVec3::new(across(frame.z.x), across(frame.z.y), across(frame.z.z));
    let ends = [frame.origin + low * frame.z, frame.origin + high * frame.z];
    [ends[0].min(ends[1]) - wide, ends[0].max(ends[1]) + wide]
}
