//! Conservative bounds of pieces of curves.

use super::Curve;
use crate::basis::span;
use glam::DVec3;

/// Chords of a conic's piece.
const CHORDS: usize = 32;

impl Curve {
    /// Places whose convex hull, widened by the distance that is returned, holds the piece of a range. Of a conic they are points
    /// of the curve, and the distance is the greatest sagitta |λ''| Δu² / 8; of a NURBS curve the control points that the piece
    /// depends on.
    pub fn hull(&self, [from, to]: [f64; 2]) -> (Vec<DVec3>, f64) {
        let (low, high) = (from.min(to), from.max(to));
        let bend = match self {
            Self::Line { .. } => return (vec![self.point(low), self.point(high)], 0.0),
            Self::Nurbs(curve) => {
                let [first, last] = curve.domain();
                // Pieces beyond the domain are those of a period before or after it.
                let all = low < first || high > last;
                let [a, b] = match all {
                    true => [0, curve.poles.len()],
                    false => {
                        let of = |u: f64| span(curve.degree, &curve.knots, u);
                        [of(low) - curve.degree, of(high) + 1]
                    }
                };
                return (curve.poles[a..b].to_vec(), 0.0);
            }
            Self::Circle { radius, .. } => radius.abs(),
            Self::Ellipse { radii, .. } => radii[0].max(radii[1]),
            Self::Hyperbola { radii, .. } => radii[0].max(radii[1]) * low.abs().max(high.abs()).cosh(),
            Self::Parabola { focal_distance, .. } => 2.0 * focal_distance,
        };
        let step = (high - low) / CHORDS as f64;
        let places = (0..=CHORDS).map(|k| self.point(low + step * k as f64)).collect();
        (places, bend * step * step / 8.0)
    }
}
