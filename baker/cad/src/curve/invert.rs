//! Parameter of a point on a curve.

use super::{Curve, NurbsCurve};
use glam::DVec3;
use rebounce_shared::elementary::Elementary;
use std::cell::Cell;
use std::collections::VecDeque;
use std::f64::consts::{FRAC_PI_2, TAU};

/// Samples a knot span, and one for each degree.
const SAMPLES: usize = 4;

/// Share by which tangents over an interval differ from the chord where the curve is nearly straight.
const STRAIGHT: f64 = 0.05;

/// So many points are evaluated between samples at most, but for the last search of a minimum.
const MAX_EVALUATIONS: u32 = 512;

impl Curve {
    /// Parameter of the point of the curve nearest to `place`. On a closed curve it is the one within half a period of `near`;
    /// without that, from 0 to 2π or in the domain.
    ///
    /// Line and circle in closed form; the other conics by Newton's method in their quadrant, bisecting where that strays;
    /// NURBS from samples of every knot span, minima between them found in the same way.
    pub fn invert(&self, place: DVec3, near: Option<f64>) -> f64 {
        let u = match self {
            Self::Line { origin, direction } => {
                let square = direction.length_squared();
                if square > 0.0 { (place - *origin).dot(*direction) / square } else { 0.0 }
            }
            Self::Circle { frame, .. } => {
                let local = frame.local(place);
                positive_angle(local.y.arc_tangent2(local.x))
            }
            Self::Ellipse { frame, radii } => {
                let local = frame.local(place);
                let u = ellipse_quadrant(*radii, local.x.abs(), local.y.abs());
                positive_angle((u.sine() * local.y.signum()).arc_tangent2(u.cosine() * local.x.signum()))
            }
            Self::Hyperbola { frame, radii } => {
                let local = frame.local(place);
                let [a, b] = *radii;
                half_line(local.y, (local.y.abs() / b).area_hyperbolic_sine(), |u| {
                    let [sinh, cosh] = [u.hyperbolic_sine(), u.hyperbolic_cosine()];
                    let [x, y] = [a * cosh - local.x, b * sinh - local.y.abs()];
                    let slope = (a * sinh).powi(2) + (b * cosh).powi(2) + x * a * cosh + y * b * sinh;
                    [x * a * sinh + y * b * cosh, slope]
                })
            }
            Self::Parabola { frame, focal_distance: f } => {
                let local = frame.local(place);
                half_line(local.y, 0.5 * local.y.abs() / f, |u| {
                    let linear = 2.0 * f - local.x;
                    [(f * u * u + linear) * u - local.y.abs(), 3.0 * f * u * u + linear]
                })
            }
            Self::Nurbs(spline) => nearest(spline, place),
        };
        match (near, self.period()) {
            (Some(near), Some(period)) => u + period * ((near - u) / period).round(),
            _ => u,
        }
    }
}

/// From 0 to 2π.
fn positive_angle(angle: f64) -> f64 {
    if angle < 0.0 { angle + TAU } else { angle }
}

/// Angle of the nearest point of an ellipse in the first quadrant.
fn ellipse_quadrant(radii: [f64; 2], x: f64, y: f64) -> f64 {
    let [a, b] = radii;
    rising_root([0.0, FRAC_PI_2], (y / b).arc_tangent2(x / a), |u| {
        let (sin, cos) = u.sine_cosine();
        let difference = a * a - b * b;
        let value = x * a * sin - y * b * cos - difference * sin * cos;
        [value, x * a * cos + y * b * sin - difference * (cos * cos - sin * sin)]
    })
}

/// Root at or above 0 of what is not positive at 0 and at last rises, with the sign of `y`.
fn half_line(y: f64, start: f64, f: impl Fn(f64) -> [f64; 2]) -> f64 {
    let mut high = start.max(1.0);
    for _ in 0..64 {
        if f(high)[0] >= 0.0 {
            break;
        }
        high *= 2.0;
    }
    rising_root([0.0, high], start, f) * y.signum()
}

/// Where a function goes from negative to positive: Newton's method in a bracket that shrinks, halving it where that leaves it.
/// `f` gives value and slope.
pub(crate) fn rising_root(bracket: [f64; 2], start: f64, f: impl Fn(f64) -> [f64; 2]) -> f64 {
    let [mut low, mut high] = bracket;
    let middle = 0.5 * (low + high);
    let mut u = start.max(low).min(high);
    for _ in 0..100 {
        let [value, slope] = f(u);
        if value == 0.0 && slope > 0.0 {
            return u;
        }
        if value < 0.0 || (value == 0.0 && u < middle) {
            low = u;
        } else {
            high = u;
        }
        let newton = u - value / slope;
        let next = if slope > 0.0 && low <= newton && newton <= high { newton } else { 0.5 * (low + high) };
        if (next - u).abs() <= 2.0 * f64::EPSILON * u.abs() || high <= low {
            return next;
        }
        u = next;
    }
    u
}

/// Parameter of the nearest point of a NURBS curve: of its ends, the samples, and the minima between samples where the
/// derivative of the distance goes from negative to positive. Intervals that may have a nearer point, as far as chords and tangents tell, are
/// halved, the widest first, and of these the nearest.
fn nearest(spline: &NurbsCurve, place: DVec3) -> f64 {
    let count = SAMPLES + spline.degree;
    let breaks = spline.breaks();
    let mut parameters = Vec::with_capacity(count * breaks.len());
    for pair in breaks.windows(2) {
        parameters.extend((0..count).map(|i| pair[0] + (pair[1] - pair[0]) * i as f64 / count as f64));
    }
    parameters.extend(breaks.last());
    let evaluations = Cell::new(0);
    let rate = |u: f64| {
        evaluations.set(evaluations.get() + 1);
        let [point, first, second] = spline.derivatives(u);
        let offset = point - place;
        [offset.dot(first), first.length_squared() + offset.dot(second)]
    };
    let sample = |u: f64| {
        let [point, first, _] = spline.derivatives(u);
        Sample {
            u,
            point,
            distance: point.distance(place),
            rate: (point - place).dot(first),
            speed: first.length(),
        }
    };
    let samples: Vec<Sample> = parameters.iter().map(|u| sample(*u)).collect();
    let mut best = samples[0];
    for sample in &samples {
        if sample.distance < best.distance {
            best = *sample;
        }
    }
    let mut intervals: Vec<[Sample; 2]> = samples.windows(2).map(|pair| [pair[0], pair[1]]).collect();
    let end = |interval: &[Sample; 2]| interval[0].distance.min(interval[1].distance);
    intervals.sort_by(|a, b| end(a).total_cmp(&end(b)));
    let mut intervals = VecDeque::from(intervals);
    while let Some([before, after]) = intervals.pop_front() {
        if evaluations.get() >= MAX_EVALUATIONS {
            break;
        }
        // At a fold the chord is short.
        let tangent = before.speed.max(after.speed) * (after.u - before.u);
        let reach = before.point.distance(after.point).max(tangent);
        let least = before.distance.min(after.distance) - reach;
        if least >= best.distance {
            continue;
        }
        if before.rate < 0.0 && after.rate > 0.0 {
            let share = before.rate / (before.rate - after.rate);
            let found =
                sample(rising_root([before.u, after.u], before.u + share * (after.u - before.u), rate));
            if found.distance < best.distance {
                best = found;
            }
        }
        // Nearly straight, and near: no second minimum.
        let chord = before.point.distance(after.point);
        let slowest = before.speed.min(after.speed) * (after.u - before.u);
        let is_straight = tangent <= (1.0 + STRAIGHT) * chord && slowest >= (1.0 - STRAIGHT) * chord;
        if is_straight && before.distance.min(after.distance) <= chord {
            continue;
        }
        if least < best.distance {
            evaluations.set(evaluations.get() + 1);
            let middle = sample(0.5 * (before.u + after.u));
            intervals.extend([[before, middle], [middle, after]]);
        }
    }
    best.u
}

/// A point of the curve.
#[derive(Clone, Copy)]
struct Sample {
    u: f64,
    point: DVec3,
    distance: f64,
    /// Of half the square of the distance, its derivative.
    rate: f64,
    /// Length of the first derivative.
    speed: f64,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::tests::every_kind;
    use crate::random::SplitMix;

    #[test]
    fn points_of_a_curve_come_back() {
        let mut numbers = SplitMix(7);
        for _ in 0..20 {
            for (curve, [low, high]) in every_kind(&mut numbers) {
                for _ in 0..20 {
                    let u = numbers.between(low, high);
                    let place = curve.point(u);
                    let found = curve.invert(place, Some(u));
                    assert!(
                        curve.point(found).distance(place) < 1e-12 * (1.0 + place.length()),
                        "{curve:?} {u}"
                    );
                    assert!((found - u).abs() < 1e-8, "{found} {u}: {curve:?}");
                    let Some(period) = curve.period() else { continue };
                    let far = curve.invert(place, Some(u + 3.2 * period));
                    assert!((far - found - 3.0 * period).abs() < 1e-9);
                    let free = curve.invert(place, None);
                    assert!((0.0..=period).contains(&free));
                }
            }
        }
    }

    #[test]
    fn no_sample_is_nearer() {
        let mut numbers = SplitMix(8);
        for _ in 0..20 {
            for (curve, [low, high]) in every_kind(&mut numbers) {
                for scale in [0.1, 1.0, 5.0] {
                    let place = scale * numbers.vector();
                    let found = curve.point(curve.invert(place, None)).distance(place);
                    for i in 0..=2000 {
                        let sample = curve.point(low + (high - low) * f64::from(i) / 2000.0);
                        assert!(found <= sample.distance(place) + 1e-12, "{curve:?} {place}");
                    }
                }
            }
        }
    }

    #[test]
    fn axes_of_conics() {
        let frame = crate::frame::Frame::default();
        let ellipse = Curve::Ellipse { frame, radii: [2.0, 1.0] };
        assert_eq!(ellipse.invert(DVec3::new(3.0, 0.0, 0.0), None), 0.0);
        assert!((ellipse.invert(DVec3::new(0.3, 0.0, 0.0), None).cosine() - 0.2).abs() < 1e-12);
        assert!((ellipse.invert(DVec3::ZERO, None).cosine()).abs() < 1e-12);
        let parabola = Curve::Parabola { frame, focal_distance: 0.25 };
        assert_eq!(parabola.invert(DVec3::new(0.2, 0.0, 0.0), None), 0.0);
        assert!((parabola.invert(DVec3::new(1.5, 0.0, 0.0), None).abs() - 2.0).abs() < 1e-12);
    }
}
