//! What is wrong with the numbers of a B-spline.

/// Why a B-spline is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SplineError {
    /// Degree 0, or above what is supported.
    #[error("degree {0} is not from 1 to {max}", max = crate::basis::MAX_DEGREE)]
    Degree(usize),
    /// Fewer control points than degree + 1, or more than what is supported.
    #[error("{poles} control points for degree {degree}")]
    PoleCount {
        /// Number of control points.
        poles: usize,
        /// Degree.
        degree: usize,
    },
    /// Not poles + degree + 1 knots.
    #[error("{found} knots, expected {expected}")]
    KnotCount {
        /// Number of knots.
        found: usize,
        /// Poles + degree + 1.
        expected: usize,
    },
    /// Not one weight a control point.
    #[error("{found} weights, expected {expected}")]
    WeightCount {
        /// Number of weights.
        found: usize,
        /// Number of control points.
        expected: usize,
    },
    /// NaN or infinite.
    #[error("a knot, control point or weight is not finite")]
    NotFinite,
    /// A knot is less than the one before it, or the domain is empty.
    #[error("knots do not ascend")]
    KnotOrder,
    /// A weight is 0 or less.
    #[error("weight {0} is not positive")]
    Weight(f64),
    /// An inner knot occurs more often than degree times, or an end more often than degree + 1 times.
    #[error("knot {knot} occurs {multiplicity} times")]
    Multiplicity {
        /// The knot.
        knot: f64,
        /// How often it occurs.
        multiplicity: usize,
    },
}
