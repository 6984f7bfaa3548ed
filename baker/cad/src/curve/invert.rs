//! Inversion: the parameter of a curve's point that is nearest to a place.

use super::{Curve, NurbsCurve};
use crate::frame::Frame;
use glam::DVec3;

/// Samples of a NURBS curve between two knots, for each of its degrees.
const SAMPLES: usize = 8;
/// Steps of Newton's iteration.
const STEPS: usize = 40;

impl Curve {
    /// Parameter of the nearest point. Of a periodic curve it is within half a period of `near`, which is 0 to a period without
    /// one. The two nearest points of a place on an axis are as good as each other.
    pub fn invert(&self, place: DVec3, near: Option<f64>) -> f64 {
        let found = match self {
            Self::Line { origin, direction } => {
                (place - *origin).dot(*direction) / direction.length_squared()
            }
            Self::Circle { frame, .. } => {
                let local = frame.local(place);
                // At the centre every point is as near.
                match local.truncate().length_squared() > 0.0 {
                    true => local.y.atan2(local.x),
                    false => near.unwrap_or_default(),
                }
            }
            Self::Ellipse { frame, radii } => self.on_ellipse(frame, *radii, place),
            Self::Hyperbola { frame, radii: [a, b] } => {
                let local = frame.local(place);
                let starts = [(local.y / b).asinh(), near.unwrap_or_default(), 0.0];
                self.best(starts, place, (local.length() / a.min(*b)).max(1.0).acosh() + 1.0)
            }
            Self::Parabola { frame, focal_distance } => {
                let local = frame.local(place);
                let far = (local.x.abs() / focal_distance).sqrt() + local.y.abs() / focal_distance + 1.0;
                self.best([0.5 * local.y / focal_distance, far.min(2.0), -far.min(2.0)], place, far)
            }
            Self::Nurbs(curve) => return self.on_nurbs(curve, place, near),
        };
        match self.period() {
            None => found,
            Some(period) => match near {
                Some(near) => found + period * ((near - found) / period).round(),
                None => found.rem_euclid(period),
            },
        }
    }

    fn on_ellipse(&self, frame: &Frame, [a, b]: [f64; 2], place: DVec3) -> f64 {
        let local = frame.local(place);
        // The angle of the circle that the ellipse is squeezed from, and those a quarter beside it.
        let start = (local.y / b).atan2(local.x / a);
        let beside = (a * local.y).atan2(b * local.x);
        self.best([start, beside, 0.5 * (start + beside)], place, f64::INFINITY)
    }

    fn on_nurbs(&self, curve: &NurbsCurve, place: DVec3, near: Option<f64>) -> f64 {
        let [first, last] = curve.domain();
        let period = self.period();
        let clamped = |u: f64| match period {
            Some(period) => first + (u - first).rem_euclid(period),
            None => u.clamp(first, last),
        };
        let between = SAMPLES * curve.degree;
        let samples = curve.breaks();
        let samples = samples.windows(2).flat_map(|ends| {
            (0..=between).map(|k| ends[0] + (ends[1] - ends[0]) * k as f64 / between as f64)
        });
        let distance = |u: f64| curve.derivatives(u)[0].distance_squared(place);
        let starts = samples.chain(near.map(clamped));
        let start = starts.map(|u| (distance(u), u)).min_by(|a, b| a.0.total_cmp(&b.0));
        let mut u = start.map_or(first, |(_, u)| u);
        let mut best = distance(u);
        for _ in 0..STEPS {
            let [at, along] = curve.derivatives(u);
            let mut step = (place - at).dot(along) / along.length_squared();
            if !step.is_finite() {
                break;
            }
            // Gauss and Newton's step, halved until it leads nearer.
            let mut next = clamped(u + step);
            while distance(next) > best && step.abs() > f64::EPSILON * (last - first) {
                step *= 0.5;
                next = clamped(u + step);
            }
            let reached = distance(next);
            if reached >= best {
                break;
            }
            (u, best) = (next, reached);
        }
        match (period, near) {
            (Some(period), Some(near)) => u + period * ((near - u) / period).round(),
            _ => u,
        }
    }

    /// The best of what Newton's iteration reaches from these parameters, none of them beyond `most` in size.
    fn best(&self, starts: [f64; 3], place: DVec3, most: f64) -> f64 {
        let distance = |u: f64| self.point(u).distance_squared(place);
        let polished = starts.map(|start| {
            let mut u = start.clamp(-most, most);
            let mut best = distance(u);
            for _ in 0..STEPS {
                let [at, along] = self.derivatives(u);
                let mut step = (place - at).dot(along) / along.length_squared();
                if !step.is_finite() {
                    break;
                }
                while distance(u + step) > best && step.abs() > f64::EPSILON {
                    step *= 0.5;
                }
                let reached = distance(u + step);
                if reached >= best {
                    break;
                }
                (u, best) = (u + step, reached);
            }
            (best, u)
        });
        polished.into_iter().min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, u)| u)
    }
}
