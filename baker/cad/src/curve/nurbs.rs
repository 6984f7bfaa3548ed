//! NURBS curve.

use glam::DVec3;

/// A rational B-spline curve.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsCurve {
    /// Degree, at least 1.
    pub degree: usize,
    /// Knots with their multiplicities written out, ascending: as many as poles + degree + 1.
    pub knots: Vec<f64>,
    /// Control points.
    pub poles: Vec<DVec3>,
    /// A positive weight a control point.
    pub weights: Vec<f64>,
}
