//! The point of a NURBS surface nearest to a place.

use super::split::spans;
use crate::surface::NurbsSurface;
use glam::{DVec2, DVec3};

/// Most steps of a descent.
const STEPS: usize = 100;

/// How many of the nearest samples a descent begins from.
const STARTS: usize = 4;

/// A search for the point nearest to a place.
pub struct Inversion<'a> {
    surface: &'a NurbsSurface,
    place: DVec3,
    low: DVec2,
    high: DVec2,
    periods: [Option<f64>; 2],
}

impl<'a> Inversion<'a> {
    /// A search on a surface.
    pub fn new(surface: &'a NurbsSurface, place: DVec3) -> Self {
        let [low, high] = surface.domain();
        Self { surface, place, low, high, periods: surface.periods() }
    }

    /// Parameters of the nearest point about `near`, or of all that samples lead to.
    pub fn nearest(&self, near: Option<DVec2>) -> DVec2 {
        if let Some(near) = near.filter(|near| near.is_finite()) {
            return self.descended(self.kept(near)).1;
        }
        let mut best = (f64::INFINITY, self.low);
        for start in self.samples() {
            let found = self.descended(start);
            if found.0 < best.0 {
                best = found;
            }
        }
        best.1
    }

    /// The samples nearest to the place, of a grid on each pair of knot spans with as many as its degrees + 1.
    fn samples(&self) -> Vec<DVec2> {
        let grid = |direction: usize| -> Vec<f64> {
            let knots = &self.surface.knots[direction];
            let count = self.surface.degrees[direction] + 1;
            let middle = |span: usize, index: usize| {
                knots[span] + (knots[span + 1] - knots[span]) * (index as f64 + 0.5) / count as f64
            };
            let spans = spans(self.surface, direction);
            spans.into_iter().flat_map(|span| (0..count).map(move |index| middle(span, index))).collect()
        };
        let [grid_u, grid_v] = [grid(0), grid(1)];
        let mut nearest: Vec<(f64, DVec2)> = Vec::with_capacity(STARTS + 1);
        for &u in &grid_u {
            for &v in &grid_v {
                let at = DVec2::new(u, v);
                let distance = self.surface.derivatives(at)[0].distance_squared(self.place);
                let rank = nearest.partition_point(|other| other.0 <= distance);
                if rank < STARTS {
                    nearest.insert(rank, (distance, at));
                    nearest.truncate(STARTS);
                }
            }
        }
        nearest.into_iter().map(|(_, at)| at).collect()
    }

    /// Parameters within the domain: moved by periods, or clamped.
    fn kept(&self, at: DVec2) -> DVec2 {
        let mut kept = at;
        for direction in 0..2 {
            let [low, high] = [self.low[direction], self.high[direction]];
            if let Some(period) = self.periods[direction]
                && !(low..=high).contains(&at[direction])
            {
                kept[direction] = low + (at[direction] - low).rem_euclid(period);
            }
            kept[direction] = kept[direction].clamp(low, high);
        }
        kept
    }

    /// The squared distance and the parameters at the end of a descent.
    fn descended(&self, start: DVec2) -> (f64, DVec2) {
        // Parameters in multiples of the domain, for the damping to have no units.
        let scale = self.high - self.low;
        let mut at = start;
        let mut damping = 1e-6;
        let mut tangents = self.surface.derivatives(at);
        let mut distance = tangents[0].distance_squared(self.place);
        for _ in 0..STEPS {
            let away = tangents[0] - self.place;
            let [by_u, by_v] = [tangents[1] * scale.x, tangents[2] * scale.y];
            let pull = DVec2::new(by_u.dot(away), by_v.dot(away));
            let [uu, uv, vv] = [by_u.length_squared(), by_u.dot(by_v), by_v.length_squared()];
            // At a border that the pull leads across, only the other parameter moves.
            let is_free = [0, 1].map(|direction| {
                self.periods[direction].is_some()
                    || (at[direction] > self.low[direction] || pull[direction] < 0.0)
                        && (at[direction] < self.high[direction] || pull[direction] > 0.0)
            });
            let floor = 1e-14 * (uu + vv);
            let [a, d] = [uu, vv].map(|diagonal| diagonal * (1.0 + damping) + floor);
            let step = match is_free {
                [true, true] => {
                    DVec2::new(d * pull.x - uv * pull.y, a * pull.y - uv * pull.x) / (a * d - uv * uv)
                }
                [true, false] => DVec2::new(pull.x / a, 0.0),
                [false, true] => DVec2::new(0.0, pull.y / d),
                [false, false] => DVec2::ZERO,
            };
            // False for what is not a number, too.
            let is_step = step.abs().max_element() > 1e-16 && step.is_finite();
            if !is_step || damping > 1e12 {
                break;
            }
            let next = self.kept(at - step * scale);
            let next_tangents = self.surface.derivatives(next);
            let next_distance = next_tangents[0].distance_squared(self.place);
            if next_distance < distance {
                (at, tangents, distance) = (next, next_tangents, next_distance);
                damping = (damping * 0.1).max(1e-15);
            } else {
                damping *= 10.0;
            }
        }
        (distance, at)
    }
}
