//! MonotoneEdge of a trimming curve, monotonic in u and in v.

use super::{QUADRANT_TOLERANCE, TrimEdge, ellipse_point};
use glam::DVec2;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::FRAC_PI_2;

/// The graph of a monotonic function v(u). Whichever way an edge goes, and whatever else crosses it, its pieces are the same
/// to the last bit: domains that share an edge agree at it.
#[derive(Clone, Copy, Debug)]
pub(super) struct MonotoneEdge {
    /// Ends in u, ascending.
    pub u: [f64; 2],
    /// v at the ends.
    pub v: [f64; 2],
    /// What lies between.
    curve: EdgeCurve,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum EdgeCurve {
    Segment,
    /// The radius along v is negative for the lower half.
    Arc {
        centre: DVec2,
        radii: DVec2,
    },
}

/// A segment of the boundary with one u: no function of it, and never below a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertical {
    pub u: f64,
    /// Ends in v, ascending.
    pub v: [f64; 2],
}

/// Pieces and vertical segments of an edge.
pub(super) fn cut(edge: &TrimEdge, pieces: &mut Vec<MonotoneEdge>, verticals: &mut Vec<Vertical>) {
    match *edge {
        TrimEdge::Segment { from, to } => push(from, to, EdgeCurve::Segment, pieces, verticals),
        TrimEdge::Arc { centre, radii, angles } => {
            let (low, high) = (angles[0].min(angles[1]), angles[0].max(angles[1]));
            let mut begin = low;
            // At the extrema in u (sin t = 0) and in v (cos t = 0).
            let mut quarter = ((low + QUADRANT_TOLERANCE) / FRAC_PI_2).floor() + 1.0;
            loop {
                let extremum = quarter * FRAC_PI_2;
                let end = if extremum < high - QUADRANT_TOLERANCE { extremum } else { high };
                let is_upper = (0.5 * (begin + end)).sine() > 0.0;
                let radii = if is_upper { radii } else { DVec2::new(radii.x, -radii.y) };
                let at = |angle| ellipse_point(centre, radii.abs(), angle);
                push(at(begin), at(end), EdgeCurve::Arc { centre, radii }, pieces, verticals);
                if end >= high {
                    break;
                }
                begin = end;
                quarter += 1.0;
            }
        }
    }
}

fn push(a: DVec2, b: DVec2, curve: EdgeCurve, pieces: &mut Vec<MonotoneEdge>, verticals: &mut Vec<Vertical>) {
    if a.x == b.x {
        if a.y != b.y {
            verticals.push(Vertical { u: a.x, v: [a.y.min(b.y), a.y.max(b.y)] });
        }
    } else {
        let (a, b) = if a.x < b.x { (a, b) } else { (b, a) };
        pieces.push(MonotoneEdge { u: [a.x, b.x], v: [a.y, b.y], curve });
    }
}

impl MonotoneEdge {
    /// v at a u between the ends.
    pub fn v_at(&self, u: f64) -> f64 {
        let v = match self.curve {
            EdgeCurve::Segment => {
                self.v[0] + (self.v[1] - self.v[0]) * ((u - self.u[0]) / (self.u[1] - self.u[0]))
            }
            EdgeCurve::Arc { centre, radii } => {
                let x = (u - centre.x) / radii.x;
                centre.y + radii.y * ((1.0 - x) * (1.0 + x)).max(0.0).sqrt()
            }
        };
        v.max(self.v[0].min(self.v[1])).min(self.v[0].max(self.v[1]))
    }

    /// Least and greatest v.
    pub fn v_range(&self) -> [f64; 2] {
        [self.v[0].min(self.v[1]), self.v[0].max(self.v[1])]
    }

    /// dv/du; infinite where an arc is vertical.
    pub fn slope_at(&self, u: f64) -> f64 {
        match self.curve {
            EdgeCurve::Segment => (self.v[1] - self.v[0]) / (self.u[1] - self.u[0]),
            EdgeCurve::Arc { centre, radii } => {
                let x = (u - centre.x) / radii.x;
                -radii.y / radii.x * x / ((1.0 - x) * (1.0 + x)).max(0.0).sqrt()
            }
        }
    }

    /// ∫ (v - v₀) du from a to b, between the ends.
    pub fn integral(&self, a: f64, b: f64, origin: f64) -> f64 {
        match self.curve {
            EdgeCurve::Segment => (0.5 * (self.v_at(a) + self.v_at(b)) - origin) * (b - a),
            EdgeCurve::Arc { centre, radii } => {
                let antiderivative = |u: f64| {
                    let x = ((u - centre.x) / radii.x).clamp(-1.0, 1.0);
                    0.5 * radii.x * radii.y * (x * ((1.0 - x) * (1.0 + x)).sqrt() + x.arc_sine())
                };
                (centre.y - origin) * (b - a) + antiderivative(b) - antiderivative(a)
            }
        }
    }

    /// ∫ (v − low) du from a to b, between the ends, with v clamped between `low` and `high`.
    pub fn clamped_integral(&self, [a, b]: [f64; 2], [low, high]: [f64; 2]) -> f64 {
        let [from, to] = self.within([a, b], [low, high]);
        let beyond = |u: f64| if self.v_at(u) > 0.5 * (low + high) { high - low } else { 0.0 };
        let before = if from > a { (from - a) * beyond(0.5 * (a + from)) } else { 0.0 };
        let after = if b > to { (b - to) * beyond(0.5 * (to + b)) } else { 0.0 };
        before + self.integral(from, to, low) + after
    }

    /// Between which u from a to b the clamped v is not `low` or `high`.
    pub fn within(&self, range: [f64; 2], [low, high]: [f64; 2]) -> [f64; 2] {
        // v is monotonic: it enters and leaves the strip once.
        let [a, b] = [low, high].map(|level| self.u_at(level, range));
        [a.min(b), a.max(b)]
    }

    /// The u from a to b where v is `level`; the nearer end if it is nowhere.
    fn u_at(&self, level: f64, [a, b]: [f64; 2]) -> f64 {
        let ends = [self.v_at(a), self.v_at(b)];
        let is_ascending = ends[0] <= ends[1];
        let [is_before, is_after] = if is_ascending {
            [level <= ends[0], level >= ends[1]]
        } else {
            [level >= ends[0], level <= ends[1]]
        };
        if is_before || is_after {
            return if is_before { a } else { b };
        }
        if matches!(self.curve, EdgeCurve::Segment) {
            return a + (b - a) * ((level - ends[0]) / (ends[1] - ends[0]));
        }
        let [mut below, mut above] = [a, b];
        loop {
            let middle = 0.5 * (below + above);
            if middle <= below || middle >= above {
                return middle;
            }
            if (self.v_at(middle) < level) == is_ascending {
                below = middle;
            } else {
                above = middle;
            }
        }
    }

    /// Whether the pieces lie on one curve: they cross nowhere.
    pub fn is_on_curve_of(&self, other: &Self) -> bool {
        match (self.curve, other.curve) {
            (EdgeCurve::Segment, EdgeCurve::Segment) => self.u == other.u && self.v == other.v,
            (a, b) => a == b,
        }
    }
}
