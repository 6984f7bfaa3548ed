//! Smallest enclosing parallelogram.

use super::{TrimEdge, TrimLoop};
use crate::frame::unit;
use glam::{DMat2, DVec2};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{PI, TAU};

/// Points of an arc, of which the parallelogram's directions are found.
const POINTS_PER_ARC: u32 = 64;
/// By this part of its width a parallelogram is made larger at each side, so that all points stay within after rounding.
const ROUNDING: f64 = 1e-14;

/// A parallelogram: origin + s a + t b for s and t in the unit square, a × b above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallelogram {
    /// The corner where s and t are 0.
    pub origin: DVec2,
    /// a and b.
    pub sides: [DVec2; 2],
}

impl Parallelogram {
    /// From s and t to the plane.
    pub fn at(&self, unit: DVec2) -> DVec2 {
        self.origin + unit.x * self.sides[0] + unit.y * self.sides[1]
    }

    /// s and t of a point of the plane; outside 0 to 1 if it is outside.
    pub fn unit(&self, at: DVec2) -> DVec2 {
        let [a, b] = self.sides;
        let from_origin = at - self.origin;
        DVec2::new(from_origin.perp_dot(b), a.perp_dot(from_origin)) / self.area()
    }

    /// Area.
    pub fn area(&self) -> f64 {
        self.sides[0].perp_dot(self.sides[1])
    }
}

/// The smallest parallelogram around points; `None` if they lie on a line or are not finite.
///
/// Schwarz, Teich, Welzl, Evans: On finding a minimal enclosing parallelogram (1994): one of each two parallel sides contains
/// an edge of the convex hull, so that only pairs of hull edges come into question. All of them are compared: O(n log n) for
/// the hull, O(h²) for its h edges.
pub fn minimal_enclosing(points: &[DVec2]) -> Option<Parallelogram> {
    let hull = convex_hull(points)?;
    let directions = minimal_directions(&hull);
    around(directions, &hull)
}

/// A parallelogram around the outlines of loops: the smallest around 64 points of each arc, moved out to the extrema of
/// the arcs across its sides; larger than the smallest one by less than 1 %. `None` where [`minimal_enclosing`] has none.
pub fn enclosing_loops(loops: &[TrimLoop]) -> Option<Parallelogram> {
    let mut points: Vec<DVec2> = loops.iter().flatten().flat_map(samples).collect();
    let directions = minimal_directions(&convex_hull(&points)?);
    points.extend(loops.iter().flatten().flat_map(|edge| extrema(edge, directions)));
    around(directions, &points)
}

fn samples(edge: &TrimEdge) -> Vec<DVec2> {
    let steps = match *edge {
        TrimEdge::Segment { .. } => 1,
        TrimEdge::Arc { .. } => POINTS_PER_ARC,
    };
    let inner = (1..steps).map(|i| edge.at(f64::from(i) / f64::from(steps)));
    edge.ends().into_iter().chain(inner).collect()
}

/// Points of an arc whose tangents have one of the directions.
fn extrema(edge: &TrimEdge, directions: [DVec2; 2]) -> Vec<DVec2> {
    let TrimEdge::Arc { centre, radii, angles } = *edge else {
        return Vec::new();
    };
    let (low, high) = (angles[0].min(angles[1]), angles[0].max(angles[1]));
    let mut points = Vec::new();
    for direction in directions {
        let normal = direction.perp() * radii;
        let angle = normal.y.arc_tangent2(normal.x);
        for angle in [angle, angle + PI] {
            if low + (angle - low).rem_euclid(TAU) <= high {
                points.push(centre + radii * unit(angle));
            }
        }
    }
    points
}

/// Counterclockwise, without points on its edges; `None` if it has no area. The monotone chain of Andrew (1979).
fn convex_hull(points: &[DVec2]) -> Option<Vec<DVec2>> {
    if !points.iter().all(|point| point.is_finite()) {
        return None;
    }
    let mut sorted = points.to_vec();
    sorted.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    let mut hull = chain(sorted.iter().copied());
    hull.extend(chain(sorted.iter().rev().copied()));
    (hull.len() >= 3).then_some(hull)
}

/// The lower half of a hull of points in the order of u, without the last point.
fn chain(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut chain: Vec<DVec2> = Vec::new();
    for point in points {
        while let [.., a, b] = chain[..]
            && (b - a).perp_dot(point - a) <= 0.0
        {
            chain.pop();
        }
        chain.push(point);
    }
    chain.pop();
    chain
}

/// Directions of two hull edges, the first × the second above 0.
fn minimal_directions(hull: &[DVec2]) -> [DVec2; 2] {
    // Each edge's direction of unit length, and the width of the hull across it.
    let strips: Vec<(DVec2, f64)> = hull
        .iter()
        .zip(hull.iter().cycle().skip(1))
        .filter_map(|(&a, &b)| {
            let direction = (b - a).try_normalize()?;
            let width = hull.iter().map(|&point| direction.perp_dot(point - a)).fold(0.0, f64::max);
            Some((direction, width))
        })
        .collect();
    let mut best = (f64::INFINITY, [DVec2::X, DVec2::Y]);
    for (i, &(a, width_a)) in strips.iter().enumerate() {
        for &(b, width_b) in &strips[i + 1..] {
            let sine = a.perp_dot(b);
            let area = width_a * width_b / sine.abs();
            if area < best.0 {
                best = (area, if sine > 0.0 { [a, b] } else { [b, a] });
            }
        }
    }
    best.1
}

/// The parallelogram with sides along two directions around points; `None` if it has no area.
fn around([a, b]: [DVec2; 2], points: &[DVec2]) -> Option<Parallelogram> {
    // About a point of theirs: coordinates far from 0 would cost digits.
    let &middle = points.first()?;
    let inverse = DMat2::from_cols(a, b).try_inverse()?;
    let (mut low, mut high) = (DVec2::ZERO, DVec2::ZERO);
    for &point in points {
        let coordinates = inverse * (point - middle);
        (low, high) = (low.min(coordinates), high.max(coordinates));
    }
    let margin = ROUNDING * (high - low)
        + DVec2::splat(4.0 * f64::EPSILON * middle.abs().max_element() / a.perp_dot(b));
    (low, high) = (low - margin, high + margin);
    let size = high - low;
    let it = Parallelogram { origin: middle + low.x * a + low.y * b, sides: [size.x * a, size.y * b] };
    (it.area().is_finite() && it.area() > 0.0).then_some(it)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix;

    /// Area of the parallelogram with sides in two directions around points.
    fn area_along(points: &[DVec2], angles: [f64; 2]) -> f64 {
        let [a, b] = angles.map(DVec2::from_angle);
        let width = |direction: DVec2| {
            let across = points.iter().map(|&point| direction.perp_dot(point));
            across.clone().fold(f64::NEG_INFINITY, f64::max) - across.fold(f64::INFINITY, f64::min)
        };
        width(a) * width(b) / a.perp_dot(b).abs()
    }

    fn is_around(it: &Parallelogram, points: &[DVec2]) -> bool {
        points.iter().all(|&point| {
            let unit = it.unit(point);
            unit.min_element() >= 0.0 && unit.max_element() <= 1.0
        })
    }

    #[test]
    fn no_pair_of_directions_has_a_smaller_one() {
        let mut random = SplitMix(1);
        for count in 3..60 {
            let stretch = DVec2::new(1.0, random.between(0.01, 1.0));
            let offset = random.point(DVec2::splat(-100.0), DVec2::splat(100.0));
            let turn = DVec2::from_angle(random.between(0.0, PI));
            let points: Vec<DVec2> = (0..count)
                .map(|_| offset + turn.rotate(random.point(DVec2::NEG_ONE, DVec2::ONE) * stretch))
                .collect();
            let it = minimal_enclosing(&points).unwrap();
            assert!(is_around(&it, &points) && it.area() > 0.0);
            // Directions of all pairs of points, those of all hull edges with them.
            let mut least = f64::INFINITY;
            if count < 12 {
                let pairs = |i: usize| (0..i).map(move |j| (i, j));
                let angles: Vec<f64> =
                    (0..count).flat_map(pairs).map(|(i, j)| (points[i] - points[j]).to_angle()).collect();
                for (i, &a) in angles.iter().enumerate() {
                    for &b in &angles[i + 1..] {
                        least = least.min(area_along(&points, [a, b]));
                    }
                }
                assert!((it.area() / least - 1.0).abs() < 1e-9, "{} {least}", it.area());
            }
            // Any directions.
            for i in 0..180 {
                for j in 0..i {
                    let angles = [f64::from(i), f64::from(j)].map(|k| (k + 0.5) / 180.0 * PI);
                    assert!(it.area() <= area_along(&points, angles) * (1.0 + 1e-9));
                }
            }
        }
    }

    #[test]
    fn parallelograms_are_their_own() {
        let mut random = SplitMix(2);
        for _ in 0..100 {
            let mut corner = || random.point(DVec2::splat(-5.0), DVec2::splat(5.0));
            let (o, a, b) = (corner(), corner(), corner());
            let points = [o, o + a, o + a + b, o + b];
            let it = minimal_enclosing(&points).unwrap();
            assert!((it.area() - a.perp_dot(b).abs()).abs() < 1e-10);
            assert!(
                it.at(it.unit(a)).distance(a) < 1e-10
                    && it.unit(it.at(DVec2::new(0.2, 0.7))).distance(DVec2::new(0.2, 0.7)) < 1e-10
            );
        }
        // A triangle's has twice its area.
        let it = minimal_enclosing(&[DVec2::ZERO, DVec2::X, DVec2::Y]).unwrap();
        assert!((it.area() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn arcs_are_within() {
        let mut random = SplitMix(3);
        for _ in 0..200 {
            let start = random.between(-7.0, 7.0);
            let arc = TrimEdge::Arc {
                centre: random.point(DVec2::splat(-10.0), DVec2::splat(10.0)),
                radii: random.point(DVec2::splat(0.1), DVec2::splat(2.0)),
                angles: [start, start + random.between(-TAU, TAU)],
            };
            let [from, to] = arc.ends();
            let it = enclosing_loops(&[vec![arc, TrimEdge::Segment { from: to, to: from }]]).unwrap();
            let points: Vec<DVec2> = (0..=5000).map(|i| arc.at(f64::from(i) / 5000.0)).collect();
            assert!(is_around(&it, &points));
            assert!(it.area() < 1.01 * minimal_enclosing(&points).unwrap().area());
        }
        // Around an ellipse each has 4 R₁ R₂ at least.
        let whole =
            TrimEdge::Arc { centre: DVec2::ONE, radii: DVec2::new(2.0, 0.5), angles: [1.0, 1.0 + TAU] };
        let area = enclosing_loops(&[vec![whole]]).unwrap().area();
        assert!((4.0 - 1e-12..4.04).contains(&area), "{area}");
    }

    #[test]
    fn points_without_area_have_none() {
        assert!(minimal_enclosing(&[]).is_none());
        assert!(minimal_enclosing(&[DVec2::ONE; 5]).is_none());
        assert!(minimal_enclosing(&[DVec2::ZERO, DVec2::ONE, DVec2::splat(2.0)]).is_none());
        assert!(minimal_enclosing(&[DVec2::ZERO, DVec2::X, DVec2::NAN]).is_none());
        assert!(enclosing_loops(&[]).is_none());
    }
}
