//! Laws of curves.

use super::{Curve, NurbsCurve};
use crate::frame::Frame;
use glam::DVec3;
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

fn frame() -> Frame {
    Frame::new(DVec3::new(0.3, -1.0, 2.0), DVec3::new(1.0, 2.0, -0.5), DVec3::X).unwrap()
}

/// A full circle as a rational curve of degree 2.
fn circle(radius: f64) -> NurbsCurve {
    let corners = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]];
    let poles = corners.map(|[x, y]| frame().place(radius * DVec3::new(f64::from(x), f64::from(y), 0.0)));
    let weights = (0..9).map(|i| if i % 2 == 0 { 1.0 } else { FRAC_1_SQRT_2 }).collect();
    let knots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4].map(f64::from);
    NurbsCurve::new(2, knots.to_vec(), poles.to_vec(), weights).unwrap()
}

/// A cubic with a knot inside.
fn wave() -> NurbsCurve {
    let poles = [[0, 0, 0], [1, 2, 0], [2, -1, 1], [3, 1, 0], [4, 0, -1]];
    let poles = poles.map(|[x, y, z]| DVec3::new(f64::from(x), f64::from(y), f64::from(z)));
    let knots = vec![0.0, 0.0, 0.0, 0.0, 0.4, 1.0, 1.0, 1.0, 1.0];
    NurbsCurve::new(3, knots, poles.to_vec(), vec![1.0, 2.0, 0.5, 1.0, 1.0]).unwrap()
}

/// One curve of each kind, and a range of its parameter.
fn all() -> Vec<(Curve, [f64; 2])> {
    vec![
        (
            Curve::Line { origin: DVec3::new(1.0, 2.0, 3.0), direction: DVec3::new(0.5, -2.0, 0.1) },
            [-2.0, 3.0],
        ),
        (Curve::Circle { frame: frame(), radius: 0.7 }, [-0.4, 5.0]),
        (Curve::Ellipse { frame: frame(), radii: [2.0, 0.6] }, [0.1, 6.0]),
        (Curve::Ellipse { frame: frame(), radii: [0.3, 1.5] }, [0.1, 6.0]),
        (Curve::Hyperbola { frame: frame(), radii: [1.0, 0.5] }, [-1.5, 2.0]),
        (Curve::Parabola { frame: frame(), focal_distance: 0.4 }, [-2.0, 1.5]),
        (Curve::Nurbs(circle(1.3)), [0.0, 4.0]),
        (Curve::Nurbs(wave()), [0.0, 1.0]),
    ]
}

#[test]
fn a_rational_circle_is_a_circle() {
    let curve = circle(1.3);
    for k in 0..=400 {
        let local = frame().local(curve.derivatives(f64::from(k) / 100.0)[0]);
        assert!((local.length() - 1.3).abs() < 1e-12 && local.z.abs() < 1e-12);
    }
    assert!((Curve::Nurbs(curve).length_between(0.0, 4.0) - TAU * 1.3).abs() < 1e-9);
}

#[test]
fn derivatives_are_those_of_differences() {
    for (curve, [from, to]) in all() {
        for k in 1..40 {
            let u = from + (to - from) * (f64::from(k) + 0.31) / 40.0;
            let step = 1e-6;
            let difference = (curve.point(u + step) - curve.point(u - step)) / (2.0 * step);
            let along = curve.derivatives(u)[1];
            assert!(along.distance(difference) < 1e-6 * (1.0 + along.length()), "{curve:?} at {u}");
        }
    }
}

#[test]
fn a_point_of_a_curve_has_its_parameter() {
    for (curve, [from, to]) in all() {
        for k in 0..60 {
            let u = from + (to - from) * (f64::from(k) + 0.17) / 60.0;
            let found = curve.invert(curve.point(u), Some(u + 0.02));
            assert!((found - u).abs() < 1e-7, "{curve:?}: {found} for {u}");
            let anywhere = curve.invert(curve.point(u), None);
            assert!(curve.point(anywhere).distance(curve.point(u)) < 1e-8, "{curve:?} at {u}");
        }
    }
}

#[test]
fn the_parameter_of_a_place_beside_a_curve_is_that_of_the_nearest_point() {
    for (curve, [from, to]) in all() {
        for k in 0..30 {
            let u = from + (to - from) * (f64::from(k) + 0.4) / 30.0;
            let place = curve.point(u) + 0.1 * DVec3::new((k as f64).sin(), (2.0 * k as f64).cos(), 0.4);
            let found = curve.point(curve.invert(place, Some(u))).distance(place);
            let samples = (0..4000).map(|s| from - 0.5 + (to - from + 1.0) * f64::from(s) / 4000.0);
            let is_in = |s: &f64| !matches!(curve, Curve::Nurbs(_)) || (*s >= from && *s <= to);
            let best = samples.filter(is_in).map(|s| curve.point(s).distance(place)).fold(f64::MAX, f64::min);
            assert!(found <= best + 1e-6, "{curve:?} at {u}: {found}, not {best}");
        }
    }
}

#[test]
fn polylines_keep_to_the_chord_error() {
    for (curve, range) in all() {
        for (range, error) in [(range, 1e-2), ([range[1], range[0]], 1e-4)] {
            let parameters = curve.flatten(range, error);
            assert!(parameters.first() == Some(&range[0]) && parameters.last() == Some(&range[1]));
            for ends in parameters.windows(2) {
                let (a, b) = (curve.point(ends[0]), curve.point(ends[1]));
                for k in 1..20 {
                    let place = curve.point(ends[0] + (ends[1] - ends[0]) * f64::from(k) / 20.0) - a;
                    let along = (place.dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
                    assert!(place.distance(along * (b - a)) <= 1.3 * error, "{curve:?}");
                }
            }
        }
    }
}

#[test]
fn what_is_no_curve_is_refused() {
    let (poles, weights) = (vec![DVec3::ZERO, DVec3::X, DVec3::Y], vec![1.0; 3]);
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let new = |degree, knots: &[f64], poles: &[DVec3], weights: &[f64]| {
        NurbsCurve::new(degree, knots.to_vec(), poles.to_vec(), weights.to_vec())
    };
    assert!(new(2, &knots, &poles, &weights).is_ok());
    assert!(new(0, &knots, &poles, &weights).is_err());
    assert!(new(2, &knots[1..], &poles, &weights).is_err());
    assert!(new(2, &[0.0, 0.0, 0.0, 1.0, 1.0, 0.5], &poles, &weights).is_err());
    assert!(new(2, &[0.0; 6], &poles, &weights).is_err());
    assert!(new(2, &knots, &poles, &[1.0, 0.0, 1.0]).is_err());
    assert!(new(2, &knots, &[DVec3::NAN, DVec3::X, DVec3::Y], &weights).is_err());
}
