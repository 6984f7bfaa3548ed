//! Faces across seams and round surfaces, in the parameter plane alone: areas by the even-odd rule.

use crate::step::period::{Ring, arrange};
use crate::step::poles::Domain;
use crate::surface::Surface;
use glam::DVec2;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

fn ring(points: &[(f64, f64)], turns: [i32; 2]) -> Ring {
    let mut points: Vec<DVec2> = points.iter().map(|at| DVec2::new(at.0, at.1)).collect();
    points.push(points[0] + TAU * DVec2::new(f64::from(turns[0]), f64::from(turns[1])));
    Ring { points, turns }
}

/// Whether a place, turns apart, is within the polygons.
fn is_within(polygons: &[Vec<DVec2>], at: DVec2, turns: &[f64]) -> bool {
    let crosses = |a: DVec2, b: DVec2, at: DVec2| {
        (a.y > at.y) != (b.y > at.y) && a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x) > at.x
    };
    let count = |at: DVec2| {
        polygons
            .iter()
            .flat_map(|polygon| polygon.iter().zip(polygon.iter().cycle().skip(1)))
            .filter(|(a, b)| crosses(**a, **b, at))
            .count()
    };
    turns.iter().any(|turn| count(at + DVec2::new(*turn * TAU, 0.0)) % 2 == 1)
}

fn assert_one_period(polygons: &[Vec<DVec2>]) {
    let all = || polygons.iter().flatten().map(|at| at.x);
    let width = all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min);
    assert!(width <= TAU * (1.0 + 1e-12), "{width}");
}

/// The expected face, compared with what the polygons enclose at 20000 places.
fn assert_encloses(polygons: &[Vec<DVec2>], v: [f64; 2], expected: impl Fn(DVec2) -> bool) {
    assert_one_period(polygons);
    for at in 0..20000 {
        let [a, b] =
            [0.754_877_666_246_693, 0.569_840_290_998_053].map(|step| (step * f64::from(at)).fract());
        let place = DVec2::new(TAU * a, v[0] + b * (v[1] - v[0]));
        assert_eq!(is_within(polygons, place, &[-1.0, 0.0, 1.0]), expected(place), "{place}");
    }
}

fn cylinder() -> Domain {
    Domain::new(&Surface::Cylinder { frame: Default::default(), radius: 1.0 })
}

fn wave(from: f64, height: f64, amplitude: f64, turn: i32) -> Ring {
    let at = |k: i32| {
        let u = from + f64::from(turn) * TAU * f64::from(k) / 64.0;
        (u, height + amplitude * (3.0 * u).sine())
    };
    ring(&(0..64).map(at).collect::<Vec<_>>(), [turn, 0])
}

fn square(u: f64, v: f64, half: f64) -> Ring {
    ring(&[(u - half, v - half), (u + half, v - half), (u + half, v + half), (u - half, v + half)], [0, 0])
}

fn turned(mut ring: Ring) -> Ring {
    ring.points.reverse();
    ring.turns = ring.turns.map(|turn| -turn);
    ring
}

#[test]
fn a_band_with_a_hole_on_the_seam() {
    for from in [0.0, 1.0, -7.0, 5.5] {
        for hole in [0.0, 3.0, 6.2] {
            let rings = vec![
                wave(from, 0.0, 0.3, 1),
                wave(from + 1.3, 2.0, 0.3, -1),
                turned(square(hole + TAU, 1.0, 0.25)),
            ];
            let polygons = arrange(rings, &cylinder()).unwrap_or_else(|_| panic!());
            assert_encloses(&polygons, [-1.0, 3.0], |at| {
                let away = (at.x - hole + PI).rem_euclid(TAU) - PI;
                let in_hole = away.abs() < 0.25 && (at.y - 1.0).abs() < 0.25;
                let line = |height: f64, at: f64| {
                    // The chord of the wave's polygon.
                    let step = TAU / 64.0;
                    let origin = if height == 0.0 { from } else { from + 1.3 };
                    let k = ((at - origin) / step).floor();
                    let [a, b] = [origin + k * step, origin + (k + 1.0) * step]
                        .map(|u| height + 0.3 * (3.0 * u).sine());
                    a + ((at - origin) / step - k) * (b - a)
                };
                at.y > line(0.0, at.x) && at.y < line(2.0, at.x) && !in_hole
            });
        }
    }
}

#[test]
fn a_helical_strip_of_several_turns() {
    let turns = 3.0;
    let strip =
        ring(&[(0.5, 0.0), (0.5 + turns * TAU, turns), (0.5 + turns * TAU, turns + 0.4), (0.5, 0.4)], [0, 0]);
    let polygons = arrange(vec![strip], &cylinder()).unwrap_or_else(|_| panic!());
    assert_encloses(&polygons, [-0.5, 4.0], |at| {
        (0..5).any(|turn| {
            let along = (at.x - 0.5 + TAU * f64::from(turn)) / TAU;
            (0.0..turns).contains(&along) && (along..along + 0.4).contains(&at.y)
        })
    });
}

#[test]
fn a_cap_ends_at_its_pole_and_holes_leave_the_rest() {
    let sphere = Domain::new(&Surface::Sphere { frame: Default::default(), radius: 1.0 });
    let range = [-FRAC_PI_2, FRAC_PI_2];
    let cap = |turn: i32| arrange(vec![wave(2.0, 0.5, 0.0, turn)], &sphere).unwrap_or_else(|_| panic!());
    assert_encloses(&cap(1), range, |at| at.y > 0.5);
    assert_encloses(&cap(-1), range, |at| at.y < 0.5);
    for hole in [0.0, 2.0, 6.0] {
        let rings = vec![turned(square(hole, 0.0, 0.4)), turned(square(hole + 2.0, 0.3, 0.2))];
        let polygons = arrange(rings, &sphere).unwrap_or_else(|_| panic!());
        let in_square = |at: DVec2, u: f64, v: f64, half: f64| {
            ((at.x - u + PI).rem_euclid(TAU) - PI).abs() < half && (at.y - v).abs() < half
        };
        assert_encloses(&polygons, range, |at| {
            !in_square(at, hole, 0.0, 0.4) && !in_square(at, hole + 2.0, 0.3, 0.2)
        });
    }
}

#[test]
fn one_loop_round_a_cylinder_encloses_nothing() {
    assert!(arrange(vec![wave(0.0, 0.0, 0.1, 1)], &cylinder()).is_err());
}
