//! Surfaces and numbers for tests.

use crate::random::SplitMix;
use crate::surface::NurbsSurface;
use glam::{DVec2, DVec3};
use std::f64::consts::FRAC_1_SQRT_2;

/// A quadratic arc of quarter circles: knots, poles and weights.
fn arc(quarters: usize, start: usize) -> (Vec<f64>, Vec<(DVec2, f64)>) {
    let mut knots = vec![0.0];
    for quarter in 0..=quarters {
        knots.extend([quarter as f64; 2]);
    }
    knots.push(quarters as f64);
    let around = [
        (1.0, 0.0),
        (1.0, 1.0),
        (0.0, 1.0),
        (-1.0, 1.0),
        (-1.0, 0.0),
        (-1.0, -1.0),
        (0.0, -1.0),
        (1.0, -1.0),
    ];
    let poles = (0..=2 * quarters)
        .map(|index| {
            let (x, y) = around[(start + index) % 8];
            (DVec2::new(x, y), if index % 2 == 0 { 1.0 } else { FRAC_1_SQRT_2 })
        })
        .collect();
    (knots, poles)
}

/// A profile in the plane of x (the distance from the axis) and z, turned about z.
fn turned(profile: (Vec<f64>, Vec<(DVec2, f64)>)) -> NurbsSurface {
    let (knots, circle) = arc(4, 0);
    let counts = [circle.len(), profile.1.len()];
    let mut poles = Vec::new();
    let mut weights = Vec::new();
    for &(direction, weight) in &circle {
        for &(at, other) in &profile.1 {
            poles.push((at.x * direction).extend(at.y));
            weights.push(weight * other);
        }
    }
    NurbsSurface::new([2, 2], [knots, profile.0], counts, poles, weights).unwrap()
}

/// A sphere about the origin: u from 0 to 4 round the z axis, v from 0 to 2 from the south pole to the north pole.
pub fn sphere(radius: f64) -> NurbsSurface {
    let (knots, poles) = arc(2, 6);
    turned((knots, poles.into_iter().map(|(at, weight)| (radius * at, weight)).collect()))
}

/// A torus about the z axis.
pub fn torus(major: f64, minor: f64) -> NurbsSurface {
    let (knots, poles) = arc(4, 0);
    let moved = |(at, weight): (DVec2, f64)| (DVec2::new(major, 0.0) + minor * at, weight);
    turned((knots, poles.into_iter().map(moved).collect()))
}

/// A bicubic patch over [-1, 1]² with random heights, weights and knots, of as many control points in u and v, at least 5.
pub fn wavy(count: usize) -> NurbsSurface {
    let mut random = SplitMix(7 + count as u64);
    let knots = [0, 1].map(|_| {
        let mut knots = vec![0.0; 4];
        knots.extend((1..count - 3).map(|knot| knot as f64 + random.between(-0.3, 0.3)));
        knots.extend([(count - 3) as f64; 4]);
        knots
    });
    let side = |index: usize| 2.0 * index as f64 / (count - 1) as f64 - 1.0;
    let poles = (0..count * count)
        .map(|index| DVec3::new(side(index / count), side(index % count), random.between(-0.6, 0.6)))
        .collect();
    let weights = (0..count * count).map(|_| random.between(0.5, 2.0)).collect();
    NurbsSurface::new([3, 3], knots, [count; 2], poles, weights).unwrap()
}
