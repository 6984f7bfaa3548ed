//! Surface of linear extrusion: σ(u, v) = λ(u) + v V.

use crate::curve::{Curve, NurbsCurve};
use crate::frame::Frame;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::FRAC_PI_4;

/// Of the size of what is compared: so much is rounding.
const ROUNDING: f64 = 1e-14;

/// A conic so much thinner than long is a segment, seen along V.
const THIN: f64 = 1e-9;

/// Of the size of the surface: distances that differ by less are the same.
const TIE: f64 = 1e-9;

/// Point, σᵤ and σᵥ.
pub fn derivatives(profile: &Curve, along: DVec3, at: DVec2) -> [DVec3; 3] {
    let [point, tangent, _] = profile.derivatives(at.x);
    [point + at.y * along, tangent, along]
}

/// Parameters of the point of the surface nearest to `place`; on a closed profile, u within half a period of `near`.
///
/// The profile is projected along V, where it is a curve of the same kind, and inverted there. A conic whose plane holds V has no
/// such projection: Gauss-Newton steps in u and v from several beginnings.
pub fn invert(profile: &Curve, along: DVec3, place: DVec3, near: Option<DVec2>) -> DVec2 {
    let near_u = near.map(|near| near.x);
    let Some(direction) = along.try_normalize() else {
        return DVec2::new(profile.invert(place, near_u), 0.0);
    };
    let flat = |vector: DVec3| vector - vector.dot(direction) * direction;
    let height = |u: f64| (place - profile.point(u)).dot(direction) / along.length();
    let u = match seen(profile, flat) {
        Some((curve, [scale, shift])) => scale * curve.invert(flat(place), None) + shift,
        None => {
            let begin = near_u.unwrap_or_else(|| profile.invert(place, None));
            let candidates = (-4..=4).map(|i| {
                let u = begin + f64::from(i) * FRAC_PI_4;
                gauss_newton(|at| derivatives(profile, along, at), place, DVec2::new(u, height(u)))
            });
            let size = place.distance(profile.point(begin));
            nearest_of(candidates, size, near).map_or(begin, |at| at.x)
        }
    };
    let u = match (near_u, profile.period()) {
        (Some(near), Some(period)) => u + period * ((near - u) / period).round(),
        (None, Some(period)) if !matches!(profile, Curve::Nurbs(_)) => u.rem_euclid(period),
        _ => u,
    };
    DVec2::new(u, height(u))
}

/// The profile projected along V, and scale and shift from its parameter to that of the profile. Of a conic, conjugate diameters
/// become axes; `None` if one of them vanishes.
fn seen(profile: &Curve, flat: impl Fn(DVec3) -> DVec3) -> Option<(Curve, [f64; 2])> {
    let same = [1.0, 0.0];
    let axes = |centre: DVec3, a: DVec3, b: DVec3| {
        let is_thin = a.length().min(b.length()) <= THIN * a.length().max(b.length());
        if is_thin { None } else { Frame::new(flat(centre), a.cross(b), a) }
    };
    let turned = |frame: &Frame, [a, b]: [f64; 2]| {
        let [a, b] = [flat(a * frame.x), flat(b * frame.y)];
        let shift = 0.5 * (2.0 * a.dot(b)).arc_tangent2(a.length_squared() - b.length_squared());
        let (sin, cos) = shift.sine_cosine();
        let [a, b] = [cos * a + sin * b, cos * b - sin * a];
        let frame = axes(frame.origin, a, b)?;
        Some((Curve::Ellipse { frame, radii: [a.length(), b.length()] }, [1.0, shift]))
    };
    match profile {
        Curve::Line { origin, direction } => {
            Some((Curve::Line { origin: flat(*origin), direction: flat(*direction) }, same))
        }
        Curve::Circle { frame, .. } if flat(frame.z).length() <= ROUNDING => {
            let curve = Curve::Circle { frame: Frame { origin: flat(frame.origin), ..*frame }, radius: 1.0 };
            Some((curve, same))
        }
        Curve::Circle { frame, radius } => turned(frame, [*radius; 2]),
        Curve::Ellipse { frame, radii } => turned(frame, *radii),
        Curve::Hyperbola { frame, radii } => {
            let [a, b] = [flat(radii[0] * frame.x), flat(radii[1] * frame.y)];
            let shift =
                0.5 * (-2.0 * a.dot(b) / (a.length_squared() + b.length_squared())).area_hyperbolic_tangent();
            let [sinh, cosh] = [shift.hyperbolic_sine(), shift.hyperbolic_cosine()];
            let [a, b] = [cosh * a + sinh * b, sinh * a + cosh * b];
            let frame = axes(frame.origin, a, b)?;
            Some((Curve::Hyperbola { frame, radii: [a.length(), b.length()] }, [1.0, shift]))
        }
        Curve::Parabola { frame, focal_distance } => {
            let [a, b] = [flat(frame.x), flat(frame.y)];
            let shift = -a.dot(b) / a.length_squared();
            let vertex = profile.point(shift);
            let b = b + shift * a;
            let frame = axes(vertex, a, b)?;
            let focal_distance = focal_distance * b.length_squared() / a.length();
            Some((Curve::Parabola { frame, focal_distance }, [b.length() / a.length(), shift]))
        }
        Curve::Nurbs(spline) => {
            let poles = spline.poles.iter().map(|pole| flat(*pole)).collect();
            Some((Curve::Nurbs(NurbsCurve { poles, ..spline.clone() }), same))
        }
    }
}

/// Periods in u and v.
pub fn periods(profile: &Curve, _along: DVec3) -> [Option<f64>; 2] {
    [profile.period(), None]
}

/// Least and greatest coordinates of a box that has in it the part of the surface between two corners of the parameter plane.
pub fn bounds(profile: &Curve, along: DVec3, patch: [DVec2; 2]) -> [DVec3; 2] {
    let hull = profile.hull([patch[0].x, patch[1].x]);
    let ends = [patch[0].y * along, patch[1].y * along];
    padded(hull.iter().flat_map(|point| ends.map(|end| *point + end)))
}

/// The box of points, larger by what rounding may have taken.
pub(crate) fn padded(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    let [low, high] = points
        .fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], point| [low.min(point), high.max(point)]);
    let margin = DVec3::splat(ROUNDING * low.abs().max(high.abs()).max_element());
    [low - margin, high + margin]
}

/// Of points of a surface, with their distances: the nearest, and of those as near to 1e-9 of `size` the one whose parameters
/// are nearest to `near`, or the first.
pub(crate) fn nearest_of(
    candidates: impl Iterator<Item = (DVec2, f64)>,
    size: f64,
    near: Option<DVec2>,
) -> Option<DVec2> {
    let candidates: Vec<_> = candidates.collect();
    let least = candidates.iter().map(|candidate| candidate.1).fold(f64::INFINITY, f64::min);
    let tied = candidates.iter().filter(|candidate| candidate.1 <= least + TIE * (size + least));
    let far = |at: &DVec2| near.map_or(0.0, |near| near.distance_squared(*at));
    tied.map(|candidate| candidate.0).min_by(|a, b| far(a).total_cmp(&far(b)))
}

/// Steps towards the point of a surface nearest to `place`, with the damping of Levenberg (1944) and Marquardt (1963), from
/// parameters `at`; and its distance. `rate` gives point, σᵤ and σᵥ.
pub(crate) fn gauss_newton(rate: impl Fn(DVec2) -> [DVec3; 3], place: DVec3, at: DVec2) -> (DVec2, f64) {
    let mut at = at;
    let mut now = rate(at);
    let mut damping = 1e-12;
    for _ in 0..60 {
        let [point, du, dv] = now;
        let offset = place - point;
        let [uu, uv, vv] =
            [du.length_squared() * (1.0 + damping), du.dot(dv), dv.length_squared() * (1.0 + damping)];
        let [u, v] = [du.dot(offset), dv.dot(offset)];
        let step = DVec2::new(u * vv - v * uv, v * uu - u * uv) / (uu * vv - uv * uv);
        if !step.is_finite() || step.length() <= ROUNDING * at.length() {
            break;
        }
        let next = rate(at + step);
        if next[0].distance_squared(place) < offset.length_squared() {
            (at, now) = (at + step, next);
            damping = (damping * 0.1).max(1e-12);
        } else if damping > 1e6 {
            break;
        } else {
            damping = (damping * 100.0).max(1e-6);
        }
    }
    (at, now[0].distance(place))
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::curve::tests::every_kind;
    use crate::random::SplitMix;

    #[test]
    fn a_circle_along_its_axis_is_a_cylinder() {
        let mut numbers = SplitMix(11);
        let frame = Frame::new(numbers.vector(), numbers.vector(), numbers.vector()).unwrap();
        let profile = Curve::Circle { frame, radius: 0.7 };
        for _ in 0..100 {
            let at = DVec2::new(numbers.between(0.0, 6.2), numbers.between(-3.0, 3.0));
            let radial = at.x.cosine() * frame.x + at.x.sine() * frame.y;
            let [point, du, dv] = derivatives(&profile, frame.z, at);
            assert!(point.distance(frame.origin + 0.7 * radial + at.y * frame.z) < 1e-14);
            assert!(du.distance(0.7 * frame.z.cross(radial)) < 1e-14 && dv == frame.z);
            let off = point + numbers.between(-0.6, 2.0) * radial;
            assert!(invert(&profile, frame.z, off, None).distance(at) < 1e-13);
        }
    }

    #[test]
    fn points_come_back_whatever_the_direction() {
        let mut numbers = SplitMix(12);
        for _ in 0..30 {
            let along = numbers.between(0.2, 2.0) * numbers.vector();
            for (profile, [low, high]) in every_kind(&mut numbers) {
                for _ in 0..10 {
                    let at = DVec2::new(numbers.between(low, high), numbers.between(-2.0, 2.0));
                    let place = derivatives(&profile, along, at)[0];
                    for near in [None, Some(at + DVec2::splat(0.01))] {
                        let found = invert(&profile, along, place, near);
                        let again = derivatives(&profile, along, found)[0];
                        assert!(again.distance(place) < 1e-9, "{again} {place} {profile:?} {along} {at}");
                    }
                }
            }
        }
    }

    #[test]
    fn bounds_hold_samples() {
        let mut numbers = SplitMix(13);
        for _ in 0..30 {
            let along = numbers.vector();
            for (profile, [low, high]) in every_kind(&mut numbers) {
                let corner = |numbers: &mut SplitMix| {
                    DVec2::new(numbers.between(low, high), numbers.between(-2.0, 2.0))
                };
                let patch = [corner(&mut numbers), corner(&mut numbers)];
                let [least, most] = bounds(&profile, along, patch);
                for _ in 0..100 {
                    let share = DVec2::new(numbers.between(0.0, 1.0), numbers.between(0.0, 1.0));
                    let point = derivatives(&profile, along, patch[0] + share * (patch[1] - patch[0]))[0];
                    assert!(point.cmpge(least).all() && point.cmple(most).all(), "{profile:?}");
                }
            }
        }
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let mut numbers = SplitMix(14);
        let along = numbers.vector();
        for (profile, [low, high]) in every_kind(&mut numbers) {
            let at = DVec2::new(low + 0.47 * (high - low), -0.4);
            agree_with_differences(|at| derivatives(&profile, along, at), at);
        }
    }

    /// Holds σᵤ and σᵥ to central differences.
    pub(crate) fn agree_with_differences(rate: impl Fn(DVec2) -> [DVec3; 3], at: DVec2) {
        let h = 1e-5;
        let [_, du, dv] = rate(at);
        for (derivative, step) in [(du, DVec2::X * h), (dv, DVec2::Y * h)] {
            let difference = (rate(at + step)[0] - rate(at - step)[0]) / (2.0 * h);
            assert!(
                difference.distance(derivative) < 1e-7 * (1.0 + derivative.length()),
                "{difference} {derivative}"
            );
        }
    }
}
