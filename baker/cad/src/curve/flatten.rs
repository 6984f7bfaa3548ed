//! Polyline along a curve.

use super::Curve;
use glam::DVec3;

/// Each smooth piece is halved at most so often.
const MAX_DEPTH: u32 = 14;

impl Curve {
    /// Parameters from `range[0]` to `range[1]`, either may be the larger, between which chords keep within `chord_error`
    /// (metres) of the curve: smooth pieces are halved until points at a quarter, half and three quarters of the parameter
    /// keep to the chord. At most 16384 chords a piece.
    pub fn flatten(&self, range: [f64; 2], chord_error: f64) -> Vec<f64> {
        let pieces = self.pieces(range);
        let mut result = vec![range[0]];
        if matches!(self, Self::Line { .. }) {
            result.push(range[1]);
            return result;
        }
        for pair in pieces.windows(2) {
            self.halve(pair[0], pair[1], chord_error, MAX_DEPTH, &mut result);
        }
        result
    }

    /// Adds the parameters after `from`, to `to`.
    fn halve(&self, from: f64, to: f64, chord_error: f64, depth: u32, result: &mut Vec<f64>) {
        let [begin, end] = [self.point(from), self.point(to)];
        let is_near = [0.25, 0.5, 0.75].iter().all(|share| {
            let point = self.point(from + share * (to - from));
            distance_to_segment(point, begin, end) <= chord_error
        });
        if is_near || depth == 0 {
            result.push(to);
        } else {
            let middle = 0.5 * (from + to);
            self.halve(from, middle, chord_error, depth - 1, result);
            self.halve(middle, to, chord_error, depth - 1, result);
        }
    }
}

/// Distance of a point to a line segment.
fn distance_to_segment(point: DVec3, begin: DVec3, end: DVec3) -> f64 {
    let along = end - begin;
    let square = along.length_squared();
    let share = if square > 0.0 { ((point - begin).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(begin + share * along)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::tests::every_kind;
    use crate::frame::Frame;
    use crate::random::SplitMix;
    use rebounce_shared::elementary::Elementary;

    #[test]
    fn chords_keep_to_the_curve() {
        let mut numbers = SplitMix(5);
        for (curve, [low, high]) in every_kind(&mut numbers) {
            for (range, error) in [([low, high], 1e-2), ([high, low], 1e-4)] {
                let parameters = curve.flatten(range, error);
                assert_eq!([parameters[0], parameters[parameters.len() - 1]], range);
                for pair in parameters.windows(2) {
                    assert_eq!(pair[0] < pair[1], range[0] < range[1]);
                    let [begin, end] = [pair[0], pair[1]].map(|u| curve.point(u));
                    for i in 1..20 {
                        let point = curve.point(pair[0] + (pair[1] - pair[0]) * f64::from(i) / 20.0);
                        let distance = distance_to_segment(point, begin, end);
                        let most = if i == 10 { error } else { 1.1 * error };
                        assert!(distance <= most, "{distance} > {error}: {curve:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_circle_has_about_the_fewest_chords() {
        let circle = Curve::Circle { frame: Frame::default(), radius: 1.0 };
        for error in [1e-2_f64, 1e-3, 1e-5] {
            let fewest = std::f64::consts::PI / (1.0 - error).arc_cosine();
            let count = circle.flatten([0.0, std::f64::consts::TAU], error).len() as f64 - 1.0;
            assert!(fewest <= count && count <= 2.0 * fewest.ceil() + 4.0, "{count} for {fewest}");
        }
        assert!(circle.flatten([0.0, 1.0], 0.0).len() <= (1 << MAX_DEPTH) + 1);
    }
}
