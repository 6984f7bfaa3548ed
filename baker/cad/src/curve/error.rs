//! What makes a NURBS curve unusable.

/// A NURBS curve that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// The degree is out of range.
    #[error("a curve of degree {0}: degrees from 1 to {max} are read", max = crate::basis::MAX_DEGREE)]
    Degree(usize),
    /// Numbers of knots, poles and weights do not fit each other.
    #[error("{knots} knots and {weights} weights do not fit {poles} poles of degree {degree}")]
    Counts {
        /// Knots, with multiplicities.
        knots: usize,
        /// Control points.
        poles: usize,
        /// Weights.
        weights: usize,
        /// Degree.
        degree: usize,
    },
    /// A knot is smaller than the one before, or the domain is empty, or a knot inside is there too often.
    #[error("knot {0} of a curve is out of order, or there too often")]
    Knots(usize),
    /// A number is not finite, or a weight not positive.
    #[error("pole {0} of a curve is not finite, or its weight is not positive")]
    Pole(usize),
}
