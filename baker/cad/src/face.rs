//! Face: a trimmed surface.

use crate::surface::Surface;
use crate::trim::TrimLoop;

/// A trimmed surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Face {
    /// The surface.
    pub surface: Surface,
    /// Whether the face's normal is against that of the surface, σᵤ × σᵥ.
    pub is_reversed: bool,
    /// Closed curves in the parameter plane, the outer one and holes, in any order and direction: by the even-odd rule, what
    /// lies within belongs to the face. On a periodic surface they lie in one period, cut open where they go round.
    pub loops: Vec<TrimLoop>,
}
