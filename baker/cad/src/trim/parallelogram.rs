//! Smallest enclosing parallelogram.

use glam::{DMat2, DVec2};

/// A parallelogram: origin + s a + t b for s and t in the unit square.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parallelogram {
    /// The corner where s and t are 0.
    pub origin: DVec2,
    /// a and b.
    pub sides: [DVec2; 2],
}
