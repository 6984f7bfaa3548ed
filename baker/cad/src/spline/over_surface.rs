//! Functions of NURBS surfaces by their Bézier pieces: inversion and bounds.

use super::inversion::Inversion;
use super::split;
use crate::basis;
use crate::surface::NurbsSurface;
use glam::{DVec2, DVec3};

impl NurbsSurface {
    /// Parameters of the point of the surface nearest to a place: of the least distance there is about `near`, or without it,
    /// of the least that is found from samples of every knot span. Within the domain; in a direction in which the surface is
    /// closed, it goes on across the seam.
    ///
    /// Damped Gauss-Newton method (Levenberg 1944, Marquardt 1963): exact to rounding errors for a place on the surface, slower the
    /// further the place is from it. Samples can miss the nearest of several parts that are near.
    pub fn invert(&self, place: DVec3, near: Option<DVec2>) -> DVec2 {
        Inversion::new(self, place).nearest(near)
    }

    /// A box about the part of the surface over a rectangle of parameters, by the control points of its Bézier pieces. What
    /// lies beyond the domain is clamped to it, or where the surface is closed, moved into it by periods.
    pub fn bounds(&self, patch: [DVec2; 2]) -> [DVec3; 2] {
        let periods = self.periods();
        let [spans_u, spans_v] = [0, 1].map(|direction| self.pieces(direction, patch, periods[direction]));
        let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for &(span_u, u) in &spans_u {
            for &(span_v, v) in &spans_v {
                let rectangle = [0, 1].map(|side| DVec2::new(u[side], v[side]));
                let [least, greatest] = split::patch(self, [span_u, span_v]).within(rectangle).bounds();
                bounds = [bounds[0].min(least), bounds[1].max(greatest)];
            }
        }
        bounds
    }

    /// Knot spans that hold parts of an interval, and the least and greatest parameter of each part.
    fn pieces(&self, direction: usize, patch: [DVec2; 2], period: Option<f64>) -> Vec<(usize, [f64; 2])> {
        let [low, high] = self.domain().map(|corner| corner[direction]);
        let [from, to] = [patch[0][direction], patch[1][direction]];
        let intervals = match period {
            Some(period) if from < low || to > high => {
                let start = low + (from - low).rem_euclid(period);
                let end = start + (to - from);
                if to - from >= period {
                    vec![[low, high]]
                } else if end > high {
                    vec![[start, high], [low, end - period]]
                } else {
                    vec![[start, end]]
                }
            }
            _ => vec![[from.clamp(low, high), to.clamp(low, high)]],
        };
        let knots = &self.knots[direction];
        let mut found = Vec::new();
        for [from, to] in intervals {
            let [first, last] = [from, to].map(|at| basis::span(self.degrees[direction], knots, at));
            for span in first..=last {
                let part = [from.max(knots[span]), to.min(knots[span + 1])];
                let is_part = part[0] < part[1] || first == last;
                if is_part && knots[span] < knots[span + 1] {
                    found.push((span, part));
                }
            }
        }
        found
    }
}
