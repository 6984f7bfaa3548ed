//! Arc length.

use super::Curve;
use crate::quadrature::GAUSS_8;

/// Of the length: halving stops where the two halves agree with the whole to so much.
const PRECISION: f64 = 1e-12;

/// Each smooth piece is halved at most so often.
const MAX_DEPTH: u32 = 12;

impl Curve {
    /// Length of the curve between two parameters, in any order, metres: Gauss-Legendre quadrature, smooth pieces halved until
    /// it settles to 1e-12 of a piece.
    pub fn length_between(&self, a: f64, b: f64) -> f64 {
        let pieces = self.pieces([a, b]);
        pieces.windows(2).map(|p| self.refine(p[0], p[1], self.quadrature(p[0], p[1]), MAX_DEPTH)).sum()
    }

    fn refine(&self, from: f64, to: f64, whole: f64, depth: u32) -> f64 {
        let middle = 0.5 * (from + to);
        let halves = [self.quadrature(from, middle), self.quadrature(middle, to)];
        let sum = halves[0] + halves[1];
        if depth == 0 || (sum - whole).abs() <= PRECISION * sum || !sum.is_finite() {
            return sum;
        }
        self.refine(from, middle, halves[0], depth - 1) + self.refine(middle, to, halves[1], depth - 1)
    }

    fn quadrature(&self, from: f64, to: f64) -> f64 {
        let [middle, half] = [0.5 * (from + to), 0.5 * (to - from)];
        let speed = |u: f64| self.derivatives(u)[1].length();
        // The rule is symmetric.
        let sum: f64 = GAUSS_8[4..]
            .iter()
            .map(|(node, weight)| weight * (speed(middle - half * node) + speed(middle + half * node)))
            .sum();
        (half * sum).abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::tests::every_kind;
    use crate::frame::Frame;
    use crate::random::SplitMix;
    use glam::DVec3;
    use rebounce_shared::elementary::Elementary;

    #[test]
    fn closed_forms() {
        let frame = Frame::default();
        let circle = Curve::Circle { frame, radius: 2.0 };
        assert!((circle.length_between(3.0, -1.0) - 8.0).abs() < 1e-12);
        let line = Curve::Line { origin: DVec3::ONE, direction: DVec3::new(3.0, 0.0, 4.0) };
        assert!((line.length_between(-1.0, 1.0) - 10.0).abs() < 1e-12);
        let parabola = Curve::Parabola { frame, focal_distance: 0.5 };
        let u = 1.5_f64;
        let exact = 0.5 * (u * (1.0 + u * u).sqrt() + u.area_hyperbolic_sine());
        assert!((parabola.length_between(0.0, u) - exact).abs() < 1e-12);
        let spline = Curve::Nurbs(crate::curve::nurbs::tests::circle());
        assert!((spline.length_between(0.0, 4.0) - std::f64::consts::TAU).abs() < 1e-11);
    }

    #[test]
    fn polylines_tend_to_it() {
        let mut numbers = SplitMix(6);
        for (curve, [low, high]) in every_kind(&mut numbers) {
            let length = curve.length_between(low, high);
            let count = 20_000;
            let place = |i: u32| curve.point(low + (high - low) * f64::from(i) / f64::from(count));
            let polyline: f64 = (0..count).map(|i| place(i).distance(place(i + 1))).sum();
            assert!((length - polyline).abs() < 1e-6 * length, "{length} {polyline}: {curve:?}");
        }
    }
}
