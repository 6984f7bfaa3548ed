//! Curves as NURBS curves: conics are rational of degree 2 (Piegl and Tiller 1997, 7.3).

use super::{Curve, NurbsCurve};
use glam::DVec3;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::FRAC_PI_2;

/// Most arcs of a conic.
const MOST_ARCS: f64 = 256.0;
/// Longest arc of a hyperbola in its parameter, so that weights stay near 1.
const HYPERBOLIC: f64 = 1.0;

impl Curve {
    /// The same points as a NURBS curve, from the first to the second end of an ascending range. Parameters agree at its knots
    /// alone. A NURBS curve is returned as it is.
    pub fn to_nurbs(&self, [from, to]: [f64; 2]) -> NurbsCurve {
        let longest = match self {
            Self::Nurbs(curve) => return curve.clone(),
            Self::Line { .. } => {
                let poles = vec![self.point(from), self.point(to)];
                return NurbsCurve {
                    degree: 1,
                    knots: vec![from, from, to, to],
                    poles,
                    weights: vec![1.0; 2],
                };
            }
            Self::Circle { .. } | Self::Ellipse { .. } => FRAC_PI_2,
            Self::Hyperbola { .. } => HYPERBOLIC,
            Self::Parabola { .. } => f64::INFINITY,
        };
        let arcs = ((to - from) / longest - 1e-9).ceil().clamp(1.0, MOST_ARCS) as usize;
        let step = (to - from) / arcs as f64;
        let mut curve =
            NurbsCurve { degree: 2, knots: vec![from; 3], poles: vec![self.point(from)], weights: vec![1.0] };
        for k in 0..arcs {
            let ends = [k, k + 1].map(|k| from + step * k as f64);
            let (pole, weight) = self.shoulder(ends);
            curve.poles.extend([pole, self.point(ends[1])]);
            curve.weights.extend([weight, 1.0]);
            curve.knots.extend([ends[1]; 2]);
        }
        curve.knots.push(to);
        curve
    }

    /// The control point between the ends of an arc, where the tangents meet, and its weight.
    fn shoulder(&self, [from, to]: [f64; 2]) -> (DVec3, f64) {
        let half = 0.5 * (to - from);
        let weight = match self {
            Self::Circle { .. } | Self::Ellipse { .. } => half.cosine(),
            Self::Hyperbola { .. } => half.hyperbolic_cosine(),
            _ => 1.0,
        };
        (self.tangents_meet(from, to), weight)
    }
}
