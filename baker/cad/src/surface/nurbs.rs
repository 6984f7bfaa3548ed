//! NURBS surface.

use glam::DVec3;

/// A rational B-spline surface.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsSurface {
    /// Degrees in u and v, at least 1.
    pub degrees: [usize; 2],
    /// Knots in u and v with their multiplicities written out, ascending: as many as poles in that direction + degree + 1.
    pub knots: [Vec<f64>; 2],
    /// Number of control points in u and v.
    pub counts: [usize; 2],
    /// Control points, v fastest: `poles[i * counts[1] + j]`.
    pub poles: Vec<DVec3>,
    /// A positive weight a control point.
    pub weights: Vec<f64>,
}
