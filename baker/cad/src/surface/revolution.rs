//! Surface of revolution: σ(u, v) = λ(v) turned by u about the z axis of a frame.

use super::extrusion::{gauss_newton, nearest_of, padded};
use crate::curve::Curve;
use crate::frame::Frame;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

/// Of the size of what is compared: a place so near to the axis is on it, a profile so near to a plane in it.
const ROUNDING: f64 = 1e-10;

/// Point, σᵤ and σᵥ.
pub fn derivatives(frame: &Frame, profile: &Curve, at: DVec2) -> [DVec3; 3] {
    let [point, tangent, _] = profile.derivatives(at.y);
    let [local, tangent] = [frame.local(point), frame.local_direction(tangent)].map(|p| turned(p, at.x));
    [frame.place(local), frame.turn(DVec3::new(-local.y, local.x, 0.0)), frame.turn(tangent)]
}

/// Parameters of the point of the surface nearest to `place`, within half a period of `near`; without that, u from 0 to 2π. On
/// the axis, u is that of `near` or 0. Where the profile crosses the axis and a point has two pairs of parameters, those
/// nearer to `near`.
///
/// The place is turned into the half planes of the profile, which is inverted there. A profile that lies in no plane with the
/// axis: that at eight angles, or `near`, then Gauss-Newton steps in u and v.
pub fn invert(frame: &Frame, profile: &Curve, place: DVec3, near: Option<DVec2>) -> DVec2 {
    let local = frame.local(place);
    let radius = local.x.hypotenuse(local.y);
    let angle = local.y.arc_tangent2(local.x);
    let near_v = near.map(|near| near.y);
    let plane = half_plane(frame, profile);
    let [first, step, count] = match plane {
        Some(first) => [first, PI, 2.0],
        None => [0.0, FRAC_PI_4, 8.0],
    };
    let is_on_axis = radius <= ROUNDING * local.length();
    let candidates = (0..count as u32).map(|i| {
        let direction = first + step * f64::from(i);
        let there = DVec3::new(radius * direction.cosine(), radius * direction.sine(), local.z);
        let v = profile.invert(frame.place(there), near_v);
        let u = match (near, is_on_axis) {
            (Some(near), true) => near.x,
            (None, true) => 0.0,
            (Some(near), false) => near.x + nearest_turn(angle - direction - near.x),
            (None, false) => (angle - direction).rem_euclid(TAU),
        };
        let at = DVec2::new(u, v);
        if plane.is_some() {
            (at, profile.point(v).distance(frame.place(there)))
        } else {
            gauss_newton(|at| derivatives(frame, profile, at), place, at)
        }
    });
    let there = near.filter(|_| plane.is_none());
    let from_near = there.map(|near| gauss_newton(|at| derivatives(frame, profile, at), place, near));
    let candidates = from_near.into_iter().chain(candidates);
    let found = nearest_of(candidates, local.length(), near).unwrap_or(DVec2::ZERO);
    let u = match near {
        _ if plane.is_some() => found.x,
        Some(near) => near.x + nearest_turn(found.x - near.x),
        None => found.x.rem_euclid(TAU),
    };
    let v = match (near, profile.period()) {
        (Some(near), Some(period)) => found.y + period * ((near.y - found.y) / period).round(),
        _ => found.y,
    };
    let v = match profile {
        Curve::Nurbs(spline) if profile.period().is_none() => {
            let [first, last] = spline.domain();
            v.max(first).min(last)
        }
        _ => v,
    };
    DVec2::new(u, v)
}

/// Periods in u and v.
pub fn periods(_frame: &Frame, profile: &Curve) -> [Option<f64>; 2] {
    [Some(TAU), profile.period()]
}

/// Least and greatest coordinates of a box that has in it the part of the surface between two corners of the parameter plane:
/// that of the arcs of the control points of the profile.
pub fn bounds(frame: &Frame, profile: &Curve, patch: [DVec2; 2]) -> [DVec3; 2] {
    let [low, high] = [patch[0].x.min(patch[1].x), patch[0].x.max(patch[1].x)];
    let hull = profile.hull([patch[0].y, patch[1].y]);
    padded(hull.iter().flat_map(|point| {
        let local = frame.local(*point);
        let [cosine, sine] = [DVec3::new(local.x, local.y, 0.0), DVec3::new(-local.y, local.x, 0.0)];
        let [cosine, sine] = [frame.turn(cosine), frame.turn(sine)];
        let at = |u: f64| frame.place(turned(local, u));
        let mut corners = [at(low).min(at(high)), at(low).max(at(high))];
        let centre = frame.place(DVec3::new(0.0, 0.0, local.z));
        for axis in 0..3 {
            let amplitude = cosine[axis].hypotenuse(sine[axis]);
            let phase = sine[axis].arc_tangent2(cosine[axis]);
            if passes(phase, low, high) {
                corners[1][axis] = centre[axis] + amplitude;
            }
            if passes(phase + PI, low, high) {
                corners[0][axis] = centre[axis] - amplitude;
            }
        }
        corners
    }))
}

/// Whether a range of angles has this one in it, a whole number of turns on or back.
fn passes(angle: f64, low: f64, high: f64) -> bool {
    angle + TAU * ((low - angle) / TAU).ceil() <= high
}

/// From -π to π.
fn nearest_turn(angle: f64) -> f64 {
    angle - TAU * (angle / TAU).round()
}

/// Turned about the z axis.
fn turned(local: DVec3, angle: f64) -> DVec3 {
    let (sin, cos) = angle.sine_cosine();
    DVec3::new(local.x * cos - local.y * sin, local.x * sin + local.y * cos, local.z)
}

/// Angle about the axis of a half plane that has in it the point of the profile that is farthest from the axis, of some; `None`
/// if the profile is not in the plane.
fn half_plane(frame: &Frame, profile: &Curve) -> Option<f64> {
    let points: Vec<DVec3> = match profile {
        Curve::Nurbs(spline) => spline.poles.iter().map(|pole| frame.local(*pole)).collect(),
        _ => [-1.0, -0.3, 0.0, 0.6, 1.0].iter().map(|u| frame.local(profile.point(*u))).collect(),
    };
    let far = points.iter().copied().max_by(|a, b| a.x.hypotenuse(a.y).total_cmp(&b.x.hypotenuse(b.y)))?;
    let angle = far.y.arc_tangent2(far.x);
    let (sin, cos) = angle.sine_cosine();
    let size = points.iter().map(|point| point.length()).fold(0.0, f64::max);
    points.iter().all(|point| (point.y * cos - point.x * sin).abs() <= ROUNDING * size).then_some(angle)
}

#[cfg(test)]
mod tests {
    use super::super::extrusion::tests::agree_with_differences;
    use super::*;
    use crate::curve::tests::every_kind;
    use crate::random::SplitMix;

    fn frame(numbers: &mut SplitMix) -> Frame {
        Frame::new(numbers.vector(), numbers.vector(), numbers.vector()).unwrap()
    }

    #[test]
    fn a_slanted_line_is_a_cone() {
        let mut numbers = SplitMix(21);
        let frame = frame(&mut numbers);
        let (radius, slope) = (0.8, 0.5_f64);
        let profile = Curve::Line {
            origin: frame.place(DVec3::new(radius, 0.0, 0.0)),
            direction: frame.turn(DVec3::new(slope, 0.0, 1.0)),
        };
        for _ in 0..100 {
            let at = DVec2::new(numbers.between(0.0, 6.2), numbers.between(-1.0, 3.0));
            let radial = at.x.cosine() * frame.x + at.x.sine() * frame.y;
            let [point, du, dv] = derivatives(&frame, &profile, at);
            let across = radius + at.y * slope;
            assert!(point.distance(frame.origin + across * radial + at.y * frame.z) < 1e-14);
            assert!(du.distance(across * frame.z.cross(radial)) < 1e-14);
            assert!(dv.distance(slope * radial + frame.z) < 1e-14);
            assert!(invert(&frame, &profile, point, None).distance(at) < 1e-12);
        }
        let apex = frame.place(DVec3::new(0.0, 0.0, -radius / slope));
        assert!((invert(&frame, &profile, apex, None) - DVec2::new(0.0, -1.6)).length() < 1e-12);
        let near = Some(DVec2::new(2.5, 0.0));
        assert!((invert(&frame, &profile, apex, near) - DVec2::new(2.5, -1.6)).length() < 1e-12);
    }

    #[test]
    fn a_line_along_the_axis_is_a_cylinder() {
        let frame = frame(&mut SplitMix(22));
        let origin = frame.place(DVec3::new(0.0, 0.4, 0.0));
        let profile = Curve::Line { origin, direction: frame.z };
        let place = frame.place(DVec3::new(-1.0, 0.0, 2.0));
        assert!(invert(&frame, &profile, place, None).distance(DVec2::new(PI / 2.0, 2.0)) < 1e-14);
    }

    #[test]
    fn a_full_circle_through_the_axis_is_a_sphere_twice() {
        let mut numbers = SplitMix(23);
        let frame = frame(&mut numbers);
        let circle = Frame::new(frame.origin, -frame.y, frame.x).unwrap();
        let profile = Curve::Circle { frame: circle, radius: 1.5 };
        for _ in 0..100 {
            let at = DVec2::new(numbers.between(0.0, TAU), numbers.between(0.0, TAU));
            let place = derivatives(&frame, &profile, at)[0];
            let near = at + DVec2::new(numbers.between(-0.5, 0.5), numbers.between(-0.5, 0.5));
            let is_at_pole = at.y.cosine().abs() < 0.5;
            assert!(is_at_pole || invert(&frame, &profile, place, Some(near)).distance(at) < 1e-12);
            assert!((place.distance(frame.origin) - 1.5).abs() < 1e-14);
        }
    }

    #[test]
    fn points_come_back_even_of_skew_profiles() {
        let mut numbers = SplitMix(24);
        for _ in 0..30 {
            let frame = frame(&mut numbers);
            for (profile, [low, high]) in every_kind(&mut numbers) {
                for _ in 0..5 {
                    let at = DVec2::new(numbers.between(-1.0, 6.0), numbers.between(low, high));
                    let place = derivatives(&frame, &profile, at)[0];
                    let found = invert(&frame, &profile, place, Some(at + DVec2::splat(0.01)));
                    let again = derivatives(&frame, &profile, found)[0];
                    assert!(again.distance(place) < 1e-8, "{again} {place} {found} {at} {profile:?}");
                }
            }
        }
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let mut numbers = SplitMix(25);
        let frame = frame(&mut numbers);
        for (profile, [low, high]) in every_kind(&mut numbers) {
            let at = DVec2::new(-0.7, low + 0.47 * (high - low));
            agree_with_differences(|at| derivatives(&frame, &profile, at), at);
        }
    }

    #[test]
    fn bounds_hold_samples() {
        let mut numbers = SplitMix(26);
        for _ in 0..30 {
            let frame = frame(&mut numbers);
            for (profile, [low, high]) in every_kind(&mut numbers) {
                let mut corner = || DVec2::new(numbers.between(-4.0, 7.0), numbers.between(low, high));
                let patch = [corner(), corner()];
                let [least, most] = bounds(&frame, &profile, patch);
                for i in 0..=20 {
                    for j in 0..=20 {
                        let share = DVec2::new(f64::from(i), f64::from(j)) / 20.0;
                        let point =
                            derivatives(&frame, &profile, patch[0] + share * (patch[1] - patch[0]))[0];
                        assert!(point.cmpge(least).all() && point.cmple(most).all(), "{profile:?}");
                    }
                }
            }
        }
    }
}
