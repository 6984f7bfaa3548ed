//! Trimmed domains: which parameters of a surface belong to a face.

use glam::DVec2;

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
