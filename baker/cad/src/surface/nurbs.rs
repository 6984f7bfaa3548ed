//! NURBS surface.

use crate::basis::{self, MAX_DEGREE, MAX_POLES};
use glam::{DVec2, DVec3, DVec4};

/// How close opposite borders of a closed surface lie, in multiples of its size.
const CLOSURE: f64 = 1e-9;

/// Why numbers describe no NURBS surface.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SurfaceError {
    /// A degree of 0 or above the highest.
    #[error("a degree of {0} is not within 1 to {MAX_DEGREE}")]
    Degree(usize),
    /// Fewer control points in a direction than degree + 1, or more in all than are allowed.
    #[error("{0} by {1} control points: fewer than the degree needs, or more than {MAX_POLES}")]
    Counts(usize, usize),
    /// There are not as many control points or weights as the counts say.
    #[error("{found} control points or weights where {expected} are due")]
    Length {
        /// As many as there are.
        found: usize,
        /// As many as there should be.
        expected: usize,
    },
    /// Knots are of the wrong number, descend, are no numbers, repeat more than degree + 1 times, or bound an empty domain.
    #[error("the knots of a direction are no knots of this degree and number of control points")]
    Knots,
    /// A control point is not finite.
    #[error("a control point is not finite")]
    Pole,
    /// A weight is not positive or not finite.
    #[error("a weight of {0} is not a positive number")]
    Weight(f64),
}

/// A rational B-spline surface.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsSurface {
    /// Degrees in u and v, at least 1.
    pub degrees: [usize; 2],
    /// Knots in u and v with their multiplicities written out, ascending: as many as poles in that direction + degree + 1.
    pub knots: [Vec<f64>; 2],
    /// Number of control points in u and v.
    pub counts: [usize; 2],
    /// Control points, v fastest: `poles[i * counts[1] + j]`.
    pub poles: Vec<DVec3>,
    /// A positive weight a control point.
    pub weights: Vec<f64>,
}

impl NurbsSurface {
    /// The surface of these numbers, checked: the functions of a surface may panic where its fields break the rules.
    ///
    /// # Errors
    /// [`SurfaceError`] says which rule they break.
    pub fn new(
        degrees: [usize; 2],
        knots: [Vec<f64>; 2],
        counts: [usize; 2],
        poles: Vec<DVec3>,
        weights: Vec<f64>,
    ) -> Result<Self, SurfaceError> {
        if let Some(&degree) = degrees.iter().find(|degree| !(1..=MAX_DEGREE).contains(*degree)) {
            return Err(SurfaceError::Degree(degree));
        }
        let expected = counts[0].saturating_mul(counts[1]);
        if counts[0] <= degrees[0] || counts[1] <= degrees[1] || expected > MAX_POLES {
            return Err(SurfaceError::Counts(counts[0], counts[1]));
        }
        for found in [poles.len(), weights.len()] {
            if found != expected {
                return Err(SurfaceError::Length { found, expected });
            }
        }
        for direction in 0..2 {
            if !are_knots(degrees[direction], counts[direction], &knots[direction]) {
                return Err(SurfaceError::Knots);
            }
        }
        if !poles.iter().all(|pole| pole.is_finite()) {
            return Err(SurfaceError::Pole);
        }
        if let Some(&weight) = weights.iter().find(|weight| !(weight.is_finite() && **weight > 0.0)) {
            return Err(SurfaceError::Weight(weight));
        }
        Ok(Self { degrees, knots, counts, poles, weights })
    }

    /// The corners of the domain, least and greatest parameters.
    pub fn domain(&self) -> [DVec2; 2] {
        let ends = |direction: usize| {
            let knots = &self.knots[direction];
            [knots[self.degrees[direction]], knots[self.counts[direction]]]
        };
        let [u, v] = [ends(0), ends(1)];
        [DVec2::new(u[0], v[0]), DVec2::new(u[1], v[1])]
    }

    /// The control point (i, j) in homogeneous coordinates, (w x, w y, w z, w).
    pub fn homogeneous(&self, i: usize, j: usize) -> DVec4 {
        let index = i * self.counts[1] + j;
        self.poles[index].extend(1.0) * self.weights[index]
    }

    /// [σ, σᵤ, σᵥ] at parameters. At a knot, derivatives are those above it; beyond the domain the outermost pieces go on.
    pub fn derivatives(&self, at: DVec2) -> [DVec3; 3] {
        let [p, q] = self.degrees;
        let spans = [basis::span(p, &self.knots[0], at.x), basis::span(q, &self.knots[1], at.y)];
        let [values_u, slopes_u, _] = basis::functions(p, &self.knots[0], spans[0], at.x);
        let [values_v, slopes_v, _] = basis::functions(q, &self.knots[1], spans[1], at.y);
        let [mut sum, mut sum_u, mut sum_v] = [DVec4::ZERO; 3];
        for i in 0..=p {
            let [mut row, mut row_v] = [DVec4::ZERO; 2];
            for j in 0..=q {
                let pole = self.homogeneous(spans[0] - p + i, spans[1] - q + j);
                row += values_v[j] * pole;
                row_v += slopes_v[j] * pole;
            }
            sum += values_u[i] * row;
            sum_u += slopes_u[i] * row;
            sum_v += values_u[i] * row_v;
        }
        let point = sum.truncate() / sum.w;
        [point, (sum_u.truncate() - sum_u.w * point) / sum.w, (sum_v.truncate() - sum_v.w * point) / sum.w]
    }

    /// The length of the domain in u and in v, where the surface is closed in that direction: opposite borders are the same
    /// curve, to 10⁻⁹ of the size of the control net.
    pub fn periods(&self) -> [Option<f64>; 2] {
        let [low, high] = self.domain();
        let least = self.poles.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let greatest = self.poles.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let tolerance = CLOSURE * (greatest - least).length();
        [0, 1].map(|direction| {
            let across = 1 - direction;
            let place = |side: f64, along: f64| {
                let mut at = DVec2::ZERO;
                at[direction] = side;
                at[across] = along;
                self.derivatives(at)[0]
            };
            // The difference of two rational curves of degree n is a rational of degree 2 n: 2 n + 1 samples a span find it.
            let samples = 2 * self.degrees[across] + 1;
            let knots = &self.knots[across][self.degrees[across]..=self.counts[across]];
            let is_closed = knots.windows(2).filter(|span| span[0] < span[1]).all(|span| {
                (0..samples).all(|sample| {
                    let along = span[0] + (span[1] - span[0]) * (sample as f64 + 0.5) / samples as f64;
                    place(low[direction], along).distance(place(high[direction], along)) <= tolerance
                })
            });
            is_closed.then(|| high[direction] - low[direction])
        })
    }
}

/// Whether knots suit a degree and a number of control points.
fn are_knots(degree: usize, count: usize, knots: &[f64]) -> bool {
    knots.len() == count + degree + 1
        && knots.iter().all(|knot| knot.is_finite())
        && knots.windows(2).all(|pair| pair[0] <= pair[1])
        && knots.windows(degree + 2).all(|run| run[0] < run[degree + 1])
        && knots[degree] < knots[count]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix;
    use crate::spline::samples::{sphere, torus, wavy};
    use rebounce_shared::elementary::Elementary;

    #[test]
    fn a_sphere_and_a_torus_are_exact() {
        let mut random = SplitMix(1);
        let [ball, ring] = [sphere(2.0), torus(3.0, 1.0)];
        assert_eq!(ball.periods(), [Some(4.0), None]);
        assert_eq!(ring.periods(), [Some(4.0), Some(4.0)]);
        for _ in 0..2000 {
            let at = DVec2::new(random.between(0.0, 4.0), random.between(0.0, 2.0));
            assert!((ball.derivatives(at)[0].length() - 2.0).abs() < 1e-12);
            let place = ring.derivatives(DVec2::new(at.x, 2.0 * at.y))[0];
            assert!(((place.truncate().length() - 3.0).hypotenuse(place.z) - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let mut random = SplitMix(2);
        for surface in [sphere(2.0), torus(3.0, 1.0), wavy(5)] {
            let [low, high] = surface.domain();
            let step = 1e-6;
            for _ in 0..500 {
                let at =
                    low + (high - low) * DVec2::new(random.between(0.01, 0.99), random.between(0.01, 0.99));
                // At a knot of these conics the second derivative jumps.
                if (at - at.round()).abs().min_element() < 1e-5 {
                    continue;
                }
                let found = surface.derivatives(at);
                for (direction, axis) in [DVec2::X, DVec2::Y].into_iter().enumerate() {
                    let ahead = surface.derivatives(at + step * axis)[0];
                    let behind = surface.derivatives(at - step * axis)[0];
                    let difference = (ahead - behind) / (2.0 * step);
                    assert!(difference.distance(found[1 + direction]) < 1e-8, "{at}");
                }
            }
        }
    }

    #[test]
    fn points_are_inverted() {
        let mut random = SplitMix(17);
        for surface in [sphere(2.0), torus(3.0, 1.0), wavy(7)] {
            let [low, high] = surface.domain();
            for _ in 0..1000 {
                let at = low + (high - low) * DVec2::new(random.between(0.0, 1.0), random.between(0.0, 1.0));
                let place = surface.derivatives(at)[0];
                let found = surface.invert(place, None);
                assert!(surface.derivatives(found)[0].distance(place) < 1e-12, "{at} {found}");
                let nudge = DVec2::new(random.between(-0.05, 0.05), random.between(-0.05, 0.05));
                let found = surface.invert(place, Some(at + nudge));
                assert!(surface.derivatives(found)[0].distance(place) < 1e-12, "{at} {found}");
                assert!(found.cmpge(low).all() && found.cmple(high).all());
            }
        }
    }

    #[test]
    fn inversion_goes_across_seams_stays_in_the_domain_and_takes_poles() {
        let ball = sphere(2.0);
        let place = ball.derivatives(DVec2::new(3.95, 1.2))[0];
        let found = ball.invert(place, Some(DVec2::new(0.05, 1.1)));
        assert!(found.distance(DVec2::new(3.95, 1.2)) < 1e-12, "{found}");
        let pole = ball.invert(DVec3::new(0.0, 0.0, 2.0), None);
        assert!(ball.derivatives(pole)[0].distance(DVec3::new(0.0, 0.0, 2.0)) < 1e-12);
        // The nearest point to one beyond a border is on the border, at a right angle to it.
        let surface = wavy(7);
        let [low, high] = surface.domain();
        let edge = surface.derivatives(DVec2::new(1.7, high.y));
        let out = edge[2] - edge[2].project_onto(edge[1]);
        let found = surface.invert(edge[0] + 0.1 * out.normalize(), None);
        assert!(found.y == high.y && (found.x - 1.7).abs() < 1e-8 && found.x > low.x, "{found}");
        // A place off the surface, along the normal.
        let [place, by_u, by_v] = surface.derivatives(DVec2::new(1.3, 2.1));
        let found = surface.invert(place + 0.01 * by_u.cross(by_v).normalize(), None);
        assert!(found.distance(DVec2::new(1.3, 2.1)) < 1e-8, "{found}");
        assert!(surface.invert(DVec3::NAN, None).is_finite());
        assert!(surface.invert(place, Some(DVec2::NAN)).is_finite());
    }

    #[test]
    fn bounds_hold_the_part_and_little_more() {
        let mut random = SplitMix(18);
        for surface in [sphere(2.0), torus(3.0, 1.0), wavy(7)] {
            let [low, high] = surface.domain();
            for _ in 0..300 {
                let [a, b] = [0, 1].map(|_| {
                    low + (high - low) * DVec2::new(random.between(0.0, 1.0), random.between(0.0, 1.0))
                });
                let patch = [a.min(b), a.max(b)];
                let [least, greatest] = surface.bounds(patch);
                let mut tight = [DVec3::INFINITY, DVec3::NEG_INFINITY];
                for index in 0..=20 * 21 {
                    let share = DVec2::new(f64::from(index / 21), f64::from(index % 21)) / 20.0;
                    let place = surface.derivatives(patch[0] + share * (patch[1] - patch[0]))[0];
                    tight = [tight[0].min(place), tight[1].max(place)];
                }
                assert!(
                    (tight[0] - least).min_element() > -1e-12 && (greatest - tight[1]).min_element() > -1e-12
                );
                assert!((greatest - least).length() < 2.5 * (tight[1] - tight[0]).length() + 1e-9);
            }
        }
        // Across the seam of a closed surface, in any period.
        let ball = sphere(2.0);
        let across = ball.bounds([DVec2::new(3.9, 0.9), DVec2::new(4.1, 1.1)]);
        let below = ball.bounds([DVec2::new(-0.1, 0.9), DVec2::new(0.1, 1.1)]);
        for side in 0..2 {
            assert!(across[side].distance(below[side]) < 1e-12);
        }
        assert!(across[0].x > 1.9 && across[0].y < -0.1 && across[1].y > 0.1);
    }

    #[test]
    fn odd_numbers_are_refused() {
        let good = wavy(5);
        let make = |change: &dyn Fn(&mut NurbsSurface)| {
            let mut bad = good.clone();
            change(&mut bad);
            NurbsSurface::new(bad.degrees, bad.knots, bad.counts, bad.poles, bad.weights)
        };
        assert!(make(&|_| ()).is_ok());
        assert_eq!(make(&|bad| bad.degrees[1] = 0), Err(SurfaceError::Degree(0)));
        assert_eq!(make(&|bad| bad.degrees[0] = 26), Err(SurfaceError::Degree(26)));
        assert_eq!(make(&|bad| bad.counts = [3, 3]), Err(SurfaceError::Counts(3, 3)));
        assert_eq!(make(&|bad| bad.counts = [usize::MAX, 9]), Err(SurfaceError::Counts(usize::MAX, 9)));
        assert!(matches!(make(&|bad| _ = bad.poles.pop()), Err(SurfaceError::Length { .. })));
        assert_eq!(make(&|bad| bad.knots[0][4] = f64::NAN), Err(SurfaceError::Knots));
        assert_eq!(make(&|bad| bad.knots[1][4] = -1.0), Err(SurfaceError::Knots));
        assert_eq!(make(&|bad| bad.knots[1].fill(0.0)), Err(SurfaceError::Knots));
        assert_eq!(make(&|bad| bad.poles[3].y = f64::INFINITY), Err(SurfaceError::Pole));
        assert_eq!(make(&|bad| bad.weights[3] = 0.0), Err(SurfaceError::Weight(0.0)));
    }
}
