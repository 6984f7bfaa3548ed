//! NURBS curve.

use super::error::CurveError;
use crate::basis::{MAX_DEGREE, functions, span};
use glam::{DVec3, DVec4};

/// Most control points of a curve.
const MAX_POLES: usize = 1_000_000;
/// Ends are one place within this share of the control points' extent.
const CLOSED: f64 = 1e-9;

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
    /// Creates a curve.
    ///
    /// # Errors
    /// [`CurveError`] for what is no curve.
    pub fn new(
        degree: usize,
        knots: Vec<f64>,
        poles: Vec<DVec3>,
        weights: Vec<f64>,
    ) -> Result<Self, CurveError> {
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(CurveError::Degree(degree));
        }
        let count = poles.len();
        let fits = (degree + 1..=MAX_POLES).contains(&count);
        if !fits || weights.len() != count || knots.len() != count + degree + 1 {
            let (knots, weights) = (knots.len(), weights.len());
            return Err(CurveError::Counts { knots, poles: count, weights, degree });
        }
        let is_bad = |i: &usize| !(poles[*i].is_finite() && weights[*i].is_finite() && weights[*i] > 0.0);
        if let Some(bad) = (0..count).find(is_bad) {
            return Err(CurveError::Pole(bad));
        }
        let is_bad = |i: &usize| {
            let is_first = *i == 0;
            !knots[*i].is_finite() || (!is_first && knots[*i] < knots[*i - 1])
        };
        if let Some(bad) = (0..knots.len()).find(is_bad) {
            return Err(CurveError::Knots(bad));
        }
        if knots[degree] >= knots[count] {
            return Err(CurveError::Knots(degree));
        }
        // Within the domain a knot of multiplicity degree + 1 would tear the curve.
        let torn = (degree + 1..count).find(|i| *i + degree < count && knots[*i] == knots[*i + degree]);
        if let Some(torn) = torn {
            return Err(CurveError::Knots(torn));
        }
        Ok(Self { degree, knots, poles, weights })
    }

    /// First and last parameter.
    pub fn domain(&self) -> [f64; 2] {
        let first = self.knots.get(self.degree).copied().unwrap_or_default();
        [first, self.knots.get(self.poles.len()).copied().unwrap_or(first)]
    }

    /// Whether the curve ends where it begins.
    pub fn is_closed(&self) -> bool {
        let [first, last] = self.domain().map(|u| self.derivatives(u)[0]);
        first.distance(last) <= CLOSED * self.extent()
    }

    /// Diagonal of the control points' box.
    pub fn extent(&self) -> f64 {
        let first = self.poles.first().copied().unwrap_or_default();
        let fold = |[low, high]: [DVec3; 2], pole: &DVec3| [low.min(*pole), high.max(*pole)];
        let [low, high] = self.poles.iter().fold([first; 2], fold);
        low.distance(high)
    }

    /// Point and derivative at a parameter; beyond the domain the end's polynomial goes on. (Piegl and Tiller 1997, A4.1, A4.2)
    pub fn derivatives(&self, u: f64) -> [DVec3; 2] {
        let span = span(self.degree, &self.knots, u);
        let [values, slopes] = functions(self.degree, &self.knots, span, u);
        let (mut at, mut along) = (DVec4::ZERO, DVec4::ZERO);
        for k in 0..=self.degree {
            let i = span - self.degree + k;
            let pole = (self.poles[i] * self.weights[i]).extend(self.weights[i]);
            at += values[k] * pole;
            along += slopes[k] * pole;
        }
        let place = at.truncate() / at.w;
        [place, (along.truncate() - along.w * place) / at.w]
    }

    /// Distinct knots of the domain.
    pub fn breaks(&self) -> Vec<f64> {
        let mut breaks = self.knots[self.degree..=self.poles.len()].to_vec();
        breaks.dedup();
        breaks
    }
}
