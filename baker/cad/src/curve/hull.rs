//! Convex hull of a piece of a curve.

use super::Curve;
use crate::basis;
use glam::DVec3;
use rebounce_shared::elementary::Elementary;

impl Curve {
    /// Points whose convex hull has in it the curve between two parameters, in any order: control points of the piece, a conic
    /// being a rational quadratic Bézier curve of each eighth of a turn or unit (Piegl and Tiller 1997, chapter 7).
    pub fn hull(&self, range: [f64; 2]) -> Vec<DVec3> {
        let [low, mut high] = [range[0].min(range[1]), range[0].max(range[1])];
        if let Self::Nurbs(spline) = self {
            let [first, last] = spline.domain();
            if high > last && low < last && self.period().is_some() || low > last || high < first {
                return spline.poles.clone();
            }
            if low < first && self.period().is_some() {
                return spline.poles.clone();
            }
            let span = |u| basis::span(spline.degree, &spline.knots, u);
            let [begin, end] = [span(low.max(first)), span(high.min(last))];
            return spline.poles[begin - spline.degree..=end].to_vec();
        }
        if let Some(period) = self.period() {
            high = high.min(low + period);
        }
        let mut hull = vec![self.point(low)];
        for pair in self.pieces([low, high]).windows(2) {
            let middle = 0.5 * (pair[0] + pair[1]);
            for [from, to] in [[pair[0], middle], [middle, pair[1]]] {
                hull.extend([self.tangents_meet(from, to), self.point(to)]);
            }
        }
        hull
    }

    /// Where the tangents at two points of a conic meet.
    pub(super) fn tangents_meet(&self, from: f64, to: f64) -> DVec3 {
        let [middle, half] = [0.5 * (from + to), 0.5 * (to - from)];
        match self {
            Self::Circle { frame, .. } | Self::Ellipse { frame, .. } => {
                frame.origin + (self.point(middle) - frame.origin) / half.cosine()
            }
            Self::Hyperbola { frame, .. } => {
                frame.origin + (self.point(middle) - frame.origin) / half.hyperbolic_cosine()
            }
            _ => self.point(from) + half * self.derivatives(from)[1],
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::curve::tests::every_kind;
    use crate::random::SplitMix;

    #[test]
    fn no_point_of_the_curve_is_beyond_in_any_direction() {
        let mut numbers = SplitMix(9);
        for _ in 0..50 {
            for (curve, [low, high]) in every_kind(&mut numbers) {
                let reach = if curve.period().is_some() { high - low } else { 0.0 };
                let range = [numbers.between(low - reach, high), numbers.between(low, high + reach)];
                let hull = curve.hull(range);
                let direction = numbers.vector();
                let most = hull.iter().map(|point| point.dot(direction)).fold(f64::NEG_INFINITY, f64::max);
                for i in 0..=200 {
                    let point = curve.point(range[0] + (range[1] - range[0]) * f64::from(i) / 200.0);
                    assert!(point.dot(direction) <= most + 1e-12, "{curve:?} {range:?}");
                }
            }
        }
    }
}
