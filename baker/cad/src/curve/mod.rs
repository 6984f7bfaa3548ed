//! Curves in space, with the parametrisations of ISO 10303-42. A plane curve (pcurve) has z = 0.

pub mod error;
mod flatten;
mod hull;
mod invert;
mod length;
pub mod nurbs;
mod to_nurbs;

use crate::frame::Frame;
pub use error::SplineError;
use glam::DVec3;
pub use nurbs::NurbsCurve;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, TAU};

/// A curve.
#[derive(Clone, Debug, PartialEq)]
pub enum Curve {
    /// λ(u) = origin + u direction; `direction` need not have unit length.
    Line {
        /// λ(0).
        origin: DVec3,
        /// λ'.
        direction: DVec3,
    },
    /// λ(u) = C + R (cos u x + sin u y); 2π periodic.
    Circle {
        /// Centre C and plane.
        frame: Frame,
        /// R.
        radius: f64,
    },
    /// λ(u) = C + R₁ cos u x + R₂ sin u y; 2π periodic.
    Ellipse {
        /// Centre C and plane.
        frame: Frame,
        /// R₁, R₂.
        radii: [f64; 2],
    },
    /// λ(u) = C + R₁ cosh u x + R₂ sinh u y.
    Hyperbola {
        /// Centre C and plane.
        frame: Frame,
        /// R₁, R₂.
        radii: [f64; 2],
    },
    /// λ(u) = C + F (u² x + 2 u y).
    Parabola {
        /// Vertex C and plane.
        frame: Frame,
        /// F.
        focal_distance: f64,
    },
    /// A B-spline, rational or not.
    Nurbs(NurbsCurve),
}

impl Curve {
    /// Point, first and second derivative at `u`. On a closed NURBS curve, `u` outside the domain is taken back by periods;
    /// on an open one it is clamped.
    pub fn derivatives(&self, u: f64) -> [DVec3; 3] {
        match self {
            Self::Line { origin, direction } => [*origin + u * *direction, *direction, DVec3::ZERO],
            Self::Circle { frame, radius } => conic(frame, ellipse(*radius, *radius, u)),
            Self::Ellipse { frame, radii } => conic(frame, ellipse(radii[0], radii[1], u)),
            Self::Hyperbola { frame, radii } => {
                let even = DVec3::new(radii[0] * u.hyperbolic_cosine(), radii[1] * u.hyperbolic_sine(), 0.0);
                let odd = DVec3::new(radii[0] * u.hyperbolic_sine(), radii[1] * u.hyperbolic_cosine(), 0.0);
                conic(frame, [even, odd, even])
            }
            Self::Parabola { frame, focal_distance: f } => conic(
                frame,
                [
                    DVec3::new(f * u * u, 2.0 * f * u, 0.0),
                    DVec3::new(2.0 * f * u, 2.0 * f, 0.0),
                    DVec3::new(2.0 * f, 0.0, 0.0),
                ],
            ),
            Self::Nurbs(spline) => {
                let [first, last] = spline.domain();
                let is_inside = first <= u && u <= last;
                if is_inside || !spline.is_closed() {
                    spline.derivatives(u)
                } else {
                    spline.derivatives(first + (u - first).rem_euclid(last - first))
                }
            }
        }
    }

    /// The point at `u`.
    pub fn point(&self, u: f64) -> DVec3 {
        self.derivatives(u)[0]
    }

    /// Period of the parameter; `None` if the curve is not closed.
    pub fn period(&self) -> Option<f64> {
        match self {
            Self::Circle { .. } | Self::Ellipse { .. } => Some(TAU),
            Self::Nurbs(spline) if spline.is_closed() => {
                let [first, last] = spline.domain();
                Some(last - first)
            }
            _ => None,
        }
    }

    /// Parameters from `range[0]` to `range[1]` between which the curve is smooth, the two among them, in that order. A conic
    /// is cut at least every quarter turn or unit. At most some thousand pieces of a curve without knots.
    pub(crate) fn pieces(&self, range: [f64; 2]) -> Vec<f64> {
        let [from, to] = range;
        let inner = match self {
            Self::Line { .. } => Vec::new(),
            Self::Nurbs(spline) => {
                let [low, high] = [from.min(to), from.max(to)];
                let mut breaks = spline.breaks();
                let mut inner = Vec::new();
                let shifts = match self.period() {
                    Some(period) if (high - low) / period < MAX_TURNS => {
                        let turn = |u: f64| ((u - breaks[0]) / period).floor() as i64;
                        (turn(low)..=turn(high)).map(|turn| turn as f64 * period).collect()
                    }
                    _ => vec![0.0],
                };
                // The last is the first of the next period.
                breaks.pop();
                for shift in shifts {
                    inner.extend(breaks.iter().map(|u| u + shift).filter(|u| low < *u && *u < high));
                }
                inner.dedup();
                if from > to {
                    inner.reverse();
                }
                inner
            }
            _ => {
                let longest = if self.period().is_some() { FRAC_PI_2 } else { 1.0 };
                let count = ((to - from).abs() / longest * (1.0 - 1e-12)).ceil().min(4.0 * MAX_TURNS);
                let count = count as u32;
                (1..count).map(|i| from + (to - from) * f64::from(i) / f64::from(count)).collect()
            }
        };
        std::iter::once(from).chain(inner).chain(std::iter::once(to)).collect()
    }
}

/// A range of more turns is not cut at each.
const MAX_TURNS: f64 = 1000.0;

/// An ellipse in its own plane with its derivatives.
fn ellipse(major: f64, minor: f64, u: f64) -> [DVec3; 3] {
    let (sin, cos) = u.sine_cosine();
    let point = DVec3::new(major * cos, minor * sin, 0.0);
    [point, DVec3::new(-major * sin, minor * cos, 0.0), -point]
}

/// From the conic's plane to space.
fn conic(frame: &Frame, [point, first, second]: [DVec3; 3]) -> [DVec3; 3] {
    [frame.place(point), frame.turn(first), frame.turn(second)]
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::random::SplitMix;

    /// A curve of every kind, placed at random, with a range of parameters.
    pub(crate) fn every_kind(numbers: &mut SplitMix) -> Vec<(Curve, [f64; 2])> {
        let frame = Frame::new(numbers.vector(), numbers.vector(), numbers.vector()).unwrap();
        let [a, b] = [numbers.between(0.5, 2.0), numbers.between(0.5, 2.0)];
        let spline = nurbs::tests::random(numbers, 3, true);
        let loose = nurbs::tests::random(numbers, 4, false);
        let domains = [spline.domain(), loose.domain()];
        vec![
            (Curve::Line { origin: numbers.vector(), direction: 3.0 * numbers.vector() }, [-2.0, 2.0]),
            (Curve::Circle { frame, radius: a }, [0.0, TAU]),
            (Curve::Ellipse { frame, radii: [a, b] }, [0.0, TAU]),
            (Curve::Hyperbola { frame, radii: [a, b] }, [-3.0, 3.0]),
            (Curve::Parabola { frame, focal_distance: a }, [-3.0, 3.0]),
            (Curve::Nurbs(spline), domains[0]),
            (Curve::Nurbs(loose), domains[1]),
            (Curve::Nurbs(nurbs::tests::circle()), [0.0, 4.0]),
        ]
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let mut numbers = SplitMix(3);
        for (curve, [low, high]) in every_kind(&mut numbers) {
            for _ in 0..50 {
                let u = numbers.between(low + 0.01, high - 0.01);
                let h = 1e-5;
                if let Curve::Nurbs(spline) = &curve
                    && spline.knots.iter().any(|knot| (knot - u).abs() < 2.0 * h)
                {
                    continue;
                }
                let [before, at, after] = [u - h, u, u + h].map(|u| curve.derivatives(u));
                for order in [0, 1] {
                    let difference = (after[order] - before[order]) / (2.0 * h);
                    let scale = 1.0 + at[order + 1].length();
                    assert!(difference.distance(at[order + 1]) < 1e-7 * scale, "{curve:?} at {u}");
                }
            }
        }
    }

    #[test]
    fn closed_curves_repeat() {
        let mut numbers = SplitMix(4);
        for (curve, [low, high]) in every_kind(&mut numbers) {
            let Some(period) = curve.period() else { continue };
            let u = numbers.between(low, high);
            for turns in [-2.0, 1.0, 5.0] {
                assert!(curve.point(u).distance(curve.point(u + turns * period)) < 1e-12);
            }
        }
    }
}
