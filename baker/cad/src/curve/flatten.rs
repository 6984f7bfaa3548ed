//! Polylines and lengths of curves.

use super::Curve;

/// Most halvings of a piece.
const DEEPEST: u32 = 20;
/// Abscissae and weights of Gauss and Legendre's quadrature with five points, on [-1, 1].
const GAUSS: [[f64; 2]; 5] = [
    [0.0, 0.568_888_888_888_888_9],
    [0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [-0.538_469_310_105_683_1, 0.478_628_670_499_366_5],
    [0.906_179_845_938_664, 0.236_926_885_056_189_1],
    [-0.906_179_845_938_664, 0.236_926_885_056_189_1],
];
/// Pieces of a length's quadrature between two breaks.
const PIECES: usize = 16;

impl Curve {
    /// Parameters of a polyline from the first to the second end of `range`, either of which may be the larger. Halves pieces
    /// until their points at a quarter, a half and three quarters are within `chord_error` of the chord.
    pub fn flatten(&self, range: [f64; 2], chord_error: f64) -> Vec<f64> {
        let mut out = vec![range[0]];
        for ends in self.breaks_within(range).windows(2) {
            self.refine([ends[0], ends[1]], chord_error, DEEPEST, &mut out);
        }
        out
    }

    /// Length of the curve between two parameters.
    pub fn length_between(&self, from: f64, to: f64) -> f64 {
        let breaks = self.breaks_within([from, to]);
        let piece = |ends: &[f64], k: usize| {
            let half = 0.5 * (ends[1] - ends[0]) / PIECES as f64;
            let middle = ends[0] + (2 * k + 1) as f64 * half;
            let sum = |[x, weight]: &[f64; 2]| weight * self.derivatives(middle + half * x)[1].length();
            GAUSS.iter().map(sum).sum::<f64>() * half.abs()
        };
        breaks.windows(2).map(|ends| (0..PIECES).map(|k| piece(ends, k)).sum::<f64>()).sum()
    }

    /// The ends of a range, and between them what keeps pieces simple: knots, quarters of a turn.
    fn breaks_within(&self, [from, to]: [f64; 2]) -> Vec<f64> {
        let (low, high) = (from.min(to), from.max(to));
        let mut inner: Vec<f64> = match self {
            Self::Line { .. } => Vec::new(),
            Self::Nurbs(curve) => {
                let [first, last] = curve.domain();
                let turns = match self.period() {
                    Some(period) => {
                        ((low - first) / period).floor() as i64..=((high - first) / period).ceil() as i64
                    }
                    None => 0..=0,
                };
                let breaks = curve.breaks();
                let shifted = |turn: i64| breaks.iter().map(move |knot| knot + turn as f64 * (last - first));
                turns.flat_map(shifted).collect()
            }
            _ => {
                let quarters = ((high - low) / std::f64::consts::FRAC_PI_2).ceil().clamp(1.0, 64.0) as usize;
                (1..quarters).map(|k| low + (high - low) * k as f64 / quarters as f64).collect()
            }
        };
        inner.retain(|u| *u > low && *u < high);
        if from > to {
            inner.reverse();
        }
        let mut out = vec![from];
        out.extend(inner);
        out.push(to);
        out.dedup();
        out
    }

    fn refine(&self, [from, to]: [f64; 2], chord_error: f64, depth: u32, out: &mut Vec<f64>) {
        let (a, b) = (self.point(from), self.point(to));
        let chord = b - a;
        let off = |share: f64| {
            let place = self.point(from + share * (to - from)) - a;
            let along = place.dot(chord) / chord.length_squared().max(f64::MIN_POSITIVE);
            (place - along.clamp(0.0, 1.0) * chord).length()
        };
        if depth == 0 || [0.25, 0.5, 0.75].into_iter().all(|share| off(share) <= chord_error) {
            out.push(to);
            return;
        }
        let middle = 0.5 * (from + to);
        self.refine([from, middle], chord_error, depth - 1, out);
        self.refine([middle, to], chord_error, depth - 1, out);
    }
}
