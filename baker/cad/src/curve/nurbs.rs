//! NURBS curve, after Piegl and Tiller, "The NURBS Book", 1997.

use super::error::SplineError;
use crate::basis::{self, MAX_DEGREE, MAX_POLES};
use glam::{DVec3, DVec4};

/// Ends nearer than this multiple of the diagonal of the control points' box are one point.
const CLOSURE: f64 = 1e-7;

/// A rational B-spline curve.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsCurve {
    /// Degree, at least 1.
    pub degree: usize,
    /// Knots with their multiplicities written out, ascending: as many as poles + degree + 1.
    pub knots: Vec<f64>,
    /// Control points.
    pub poles: Vec<DVec3>,
    /// A positive weight a control point.
    pub weights: Vec<f64>,
}

impl NurbsCurve {
    /// The curve of these numbers, checked.
    ///
    /// # Errors
    ///
    /// Counts that do not fit together or are too large, numbers that are not finite, knots that descend or leave the curve in
    /// pieces, weights that are not positive.
    pub fn new(
        degree: usize,
        knots: Vec<f64>,
        poles: Vec<DVec3>,
        weights: Vec<f64>,
    ) -> Result<Self, SplineError> {
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(SplineError::Degree(degree));
        }
        if poles.len() <= degree || poles.len() > MAX_POLES {
            return Err(SplineError::PoleCount { poles: poles.len(), degree });
        }
        if weights.len() != poles.len() {
            return Err(SplineError::WeightCount { found: weights.len(), expected: poles.len() });
        }
        if !poles.iter().all(|pole| pole.is_finite()) || !weights.iter().all(|weight| weight.is_finite()) {
            return Err(SplineError::NotFinite);
        }
        if let Some(&weight) = weights.iter().find(|weight| **weight <= 0.0) {
            return Err(SplineError::Weight(weight));
        }
        check_knots(degree, poles.len(), &knots)?;
        Ok(Self { degree, knots, poles, weights })
    }

    /// First and last parameter.
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[self.degree], self.knots[self.poles.len()]]
    }

    /// Whether the curve ends where it begins, to 1e-7 of the diagonal of the control points' box.
    pub fn is_closed(&self) -> bool {
        let [first, last] = self.domain();
        let low = self.poles.iter().copied().fold(DVec3::INFINITY, DVec3::min);
        let high = self.poles.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
        let gap = self.derivatives(first)[0].distance(self.derivatives(last)[0]);
        gap <= CLOSURE * low.distance(high)
    }

    /// Parameters where the curve may be less smooth, ascending: the different knots of the domain, its ends among them.
    pub fn breaks(&self) -> Vec<f64> {
        let mut breaks = self.knots[self.degree..=self.poles.len()].to_vec();
        breaks.dedup();
        breaks
    }

    /// Point, first and second derivative at `u`, which is clamped to the domain. At a knot, those of the span after it; at
    /// the end of the domain, those of the last span. Basis functions by algorithm A2.2 and equation 2.7, quotients by A4.2.
    pub fn derivatives(&self, u: f64) -> [DVec3; 3] {
        let [first, last] = self.domain();
        let u = u.max(first).min(last);
        let degree = self.degree;
        let span = basis::span(degree, &self.knots, u);
        let basis = basis::functions(degree, &self.knots, span, u);
        let mut sums = [DVec4::ZERO; 3];
        for k in 0..=degree {
            let index = span - degree + k;
            let weight = self.weights[index];
            let pole = (self.poles[index] * weight).extend(weight);
            for (sum, row) in sums.iter_mut().zip(&basis) {
                *sum += row[k] * pole;
            }
        }
        let [a, da, dda] = sums;
        let point = a.truncate() / a.w;
        let first = (da.truncate() - da.w * point) / a.w;
        let second = (dda.truncate() - 2.0 * da.w * first - dda.w * point) / a.w;
        [point, first, second]
    }
}

/// Whether these knots are those of one connected B-spline of this degree with so many control points.
///
/// # Errors
///
/// Wrong count, not finite, descending, an empty domain, multiplicities at which the spline would fall apart.
pub(crate) fn check_knots(degree: usize, poles: usize, knots: &[f64]) -> Result<(), SplineError> {
    if knots.len() != poles + degree + 1 {
        return Err(SplineError::KnotCount { found: knots.len(), expected: poles + degree + 1 });
    }
    if !knots.iter().all(|knot| knot.is_finite()) {
        return Err(SplineError::NotFinite);
    }
    let [first, last] = [knots[degree], knots[poles]];
    if first >= last || knots.windows(2).any(|pair| pair[0] > pair[1]) {
        return Err(SplineError::KnotOrder);
    }
    for same in knots.chunk_by(|a, b| a == b) {
        let most = if first < same[0] && same[0] < last { degree } else { degree + 1 };
        if same.len() > most {
            return Err(SplineError::Multiplicity { knot: same[0], multiplicity: same.len() });
        }
    }
    Ok(())
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::random::SplitMix;

    /// The unit circle of nine control points.
    pub(crate) fn circle() -> NurbsCurve {
        let corner = 0.5_f64.sqrt();
        let poles = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1), (1, 0)];
        NurbsCurve::new(
            2,
            vec![0., 0., 0., 1., 1., 2., 2., 3., 3., 4., 4., 4.],
            poles.iter().map(|&(x, y)| DVec3::new(f64::from(x), f64::from(y), 0.0)).collect(),
            (0..9).map(|i| if i % 2 == 0 { 1.0 } else { corner }).collect(),
        )
        .unwrap()
    }

    /// A curve of random control points along x; unclamped knots where asked for.
    pub(crate) fn random(random: &mut SplitMix, degree: usize, is_clamped: bool) -> NurbsCurve {
        let count = degree + 5;
        let mut knots = vec![0.0];
        for i in 1..=count + degree {
            let is_end = is_clamped && (i <= degree || i > count);
            knots.push(knots[i - 1] + if is_end { 0.0 } else { random.between(0.5, 1.5) });
        }
        let poles = (0..count).map(|i| random.vector() + DVec3::X * i as f64).collect();
        NurbsCurve::new(degree, knots, poles, (0..count).map(|_| random.between(0.5, 2.0)).collect()).unwrap()
    }

    #[test]
    fn a_rational_quadratic_is_a_circle() {
        let circle = circle();
        assert!(circle.is_closed());
        for i in 0..=1000 {
            let [point, first, second] = circle.derivatives(4.0 * f64::from(i) / 1000.0);
            assert!((point.length() - 1.0).abs() < 1e-12);
            assert!(first.dot(point).abs() < 1e-12);
            let curvature = first.cross(second).length() / first.length().powi(3);
            assert!((curvature - 1.0).abs() < 1e-11, "{curvature}");
        }
    }

    #[test]
    fn derivatives_are_limits_of_differences() {
        let mut numbers = SplitMix(1);
        for degree in [1, 2, 3, 5, 9] {
            for is_clamped in [false, true] {
                let curve = random(&mut numbers, degree, is_clamped);
                for pair in curve.breaks().windows(2) {
                    let h = 1e-5;
                    let u = pair[0] + (pair[1] - pair[0]) * numbers.between(0.1, 0.9);
                    let [before, at, after] = [u - h, u, u + h].map(|u| curve.derivatives(u));
                    for order in [0, 1] {
                        let difference = (after[order] - before[order]) / (2.0 * h);
                        let scale = 1.0 + at[order + 1].length();
                        assert!(difference.distance(at[order + 1]) < 1e-6 * scale, "degree {degree}");
                    }
                }
            }
        }
    }

    #[test]
    fn basis_functions_sum_to_one() {
        let mut numbers = SplitMix(2);
        for degree in [1, 3, MAX_DEGREE] {
            let curve = random(&mut numbers, degree, true);
            let u = numbers.between(0.0, curve.domain()[1]);
            let span = basis::span(degree, &curve.knots, u);
            let [values, first, second] = basis::functions(degree, &curve.knots, span, u);
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-12);
            assert!(first.iter().sum::<f64>().abs() < 1e-10);
            assert!(second.iter().sum::<f64>().abs() < 1e-8);
        }
    }

    #[test]
    fn what_is_no_spline_is_refused() {
        let poles = vec![DVec3::ZERO, DVec3::X, DVec3::Y];
        let make = |degree, knots: &[f64], weights: &[f64]| {
            NurbsCurve::new(degree, knots.to_vec(), poles.clone(), weights.to_vec()).err()
        };
        let one = [1.0; 3];
        assert_eq!(make(2, &[0., 0., 0., 1., 1., 1.], &one), None);
        assert_eq!(make(0, &[0., 0., 1., 1.], &one), Some(SplineError::Degree(0)));
        assert_eq!(make(26, &[], &one), Some(SplineError::Degree(26)));
        assert_eq!(make(3, &[0.; 7], &one), Some(SplineError::PoleCount { poles: 3, degree: 3 }));
        assert_eq!(make(2, &[0.; 5], &one), Some(SplineError::KnotCount { found: 5, expected: 6 }));
        assert_eq!(make(2, &[0.; 6], &one[..2]), Some(SplineError::WeightCount { found: 2, expected: 3 }));
        assert_eq!(make(2, &[0., 0., 0., 1., 1., f64::NAN], &one), Some(SplineError::NotFinite));
        assert_eq!(make(2, &[0., 0., 0., 0., 0., 0.], &one), Some(SplineError::KnotOrder));
        assert_eq!(make(2, &[0., 0., 0., 1., 1., 0.5], &one), Some(SplineError::KnotOrder));
        assert_eq!(make(2, &[0., 0., 0., 1., 1., 1.], &[1., 0., 1.]), Some(SplineError::Weight(0.0)));
        assert_eq!(make(1, &[0., 0.5, 0.5, 0.5, 1.], &one), Some(SplineError::KnotOrder));
        let four = vec![DVec3::ZERO; 4];
        let torn = NurbsCurve::new(1, vec![0., 0., 1., 1., 2., 2.], four, vec![1.0; 4]).err();
        assert_eq!(torn, Some(SplineError::Multiplicity { knot: 1.0, multiplicity: 2 }));
    }
}
