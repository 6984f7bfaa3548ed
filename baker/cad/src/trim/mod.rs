//! Trimmed domains: which parameters of a surface belong to a face.
//!
//! | module | what it has |
//! |---|---|
//! | [`trapezoidal_map`] | point location among trimming curves, cells empty, plain and on the boundary, area |
//! | [`parallelogram`] | smallest enclosing parallelogram |
//!
//! [`TrapezoidalMap`] cuts curves into pieces ([`piece`]) between slabs, also where they cross ([`crossing`]).

use glam::DVec2;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{FRAC_PI_2, TAU};

mod crossing;
pub mod parallelogram;
mod piece;
#[cfg(test)]
mod tests;
pub mod trapezoidal_map;

pub use parallelogram::Parallelogram;
pub use trapezoidal_map::{Coverage, TrapezoidalMap, TrimError};

/// A piece of a trimming curve in the parameter plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TrimEdge {
    /// A line segment.
    Segment {
        /// Beginning.
        from: DVec2,
        /// End.
        to: DVec2,
    },
    /// An arc of an ellipse whose axes are those of the plane: from + radii (cos t, sin t) about `centre`.
    Arc {
        /// Centre.
        centre: DVec2,
        /// Radii along u and v, above 0.
        radii: DVec2,
        /// Angle t of the beginning and the end, radians; descending for a clockwise arc; at most 2π apart.
        angles: [f64; 2],
    },
}

/// A closed curve: each edge begins where the one before it ends, the first where the last ends.
pub type TrimLoop = Vec<TrimEdge>;

/// How far from a multiple of π/2 an angle still counts as one, radians: rounding of angles up to 2π.
const QUADRANT_TOLERANCE: f64 = 4e-15;

impl TrimEdge {
    /// Beginning and end.
    pub fn ends(&self) -> [DVec2; 2] {
        match *self {
            Self::Segment { from, to } => [from, to],
            Self::Arc { centre, radii, angles } => angles.map(|t| ellipse_point(centre, radii, t)),
        }
    }

    /// The point at a fraction of the edge, 0 to 1; for arcs, of the angle.
    pub fn at(&self, fraction: f64) -> DVec2 {
        match *self {
            Self::Segment { from, to } => from.lerp(to, fraction),
            Self::Arc { centre, radii, angles: [a, b] } => {
                ellipse_point(centre, radii, a + (b - a) * fraction)
            }
        }
    }

    /// The same points the other way round.
    pub fn reversed(&self) -> Self {
        match *self {
            Self::Segment { from, to } => Self::Segment { from: to, to: from },
            Self::Arc { centre, radii, angles: [a, b] } => Self::Arc { centre, radii, angles: [b, a] },
        }
    }

    /// Signed area that the line from a point to the edge sweeps, positive counterclockwise: summed along a loop, the area within
    /// by Green's theorem.
    pub fn swept_area(&self, about: DVec2) -> f64 {
        let [from, to] = self.ends();
        match *self {
            Self::Segment { .. } => 0.5 * (from - about).perp_dot(to - about),
            Self::Arc { centre, radii, angles: [a, b] } => {
                0.5 * ((centre - about).perp_dot(to - from) + radii.x * radii.y * (b - a))
            }
        }
    }

    /// Points from the beginning to the end, both with them, no farther than `chord_error` from their chords. The same
    /// points, in reverse, for the reversed edge.
    pub fn flattened(&self, chord_error: f64) -> Vec<DVec2> {
        match *self {
            Self::Segment { from, to } => vec![from, to],
            Self::Arc { centre, radii, angles: [a, b] } => {
                // The sagitta of a step s of angle is at most r (1 - cos s/2), of which the affine map to the circle of radius
                // r, the larger one, is the worst case.
                let cosine = (1.0 - chord_error.max(0.0) / radii.max_element()).max(-1.0);
                let longest = (2.0 * cosine.arc_cosine()).clamp(1e-3, FRAC_PI_2);
                let steps = ((b - a).abs().min(TAU) / longest).ceil().max(1.0) as u32;
                let (low, high) = (a.min(b), a.max(b));
                let point = |i: u32| {
                    ellipse_point(centre, radii, low + (high - low) * (f64::from(i) / f64::from(steps)))
                };
                let mut points: Vec<DVec2> = (0..=steps).map(point).collect();
                if a > b {
                    points.reverse();
                }
                points
            }
        }
    }
}

/// The point of an ellipse at an angle; exact at multiples of π/2, so that half and quarter discs have no gaps.
fn ellipse_point(centre: DVec2, radii: DVec2, angle: f64) -> DVec2 {
    let quarter = (angle / FRAC_PI_2).round();
    let unit = if (angle - quarter * FRAC_PI_2).abs() <= QUADRANT_TOLERANCE {
        match quarter.rem_euclid(4.0) as u8 {
            0 => DVec2::X,
            1 => DVec2::Y,
            2 => DVec2::NEG_X,
            _ => DVec2::NEG_Y,
        }
    } else {
        DVec2::new(angle.cosine(), angle.sine())
    };
    centre + radii * unit
}
