//! The basis: weight functions around points, normalised per level (paper, sections 2.1 and 2.2).
//!
//! * [`Evaluator`] finds and weighs the functions that cover a place, fast;
//! * [`Relations`] holds who is whose parent and child. The file does not store them: they follow from the points, and
//!   baker and reader work them out by the same arithmetic.
//!
//! Levels are nested here, unlike the paper's: a point's value is its coefficient plus what its
//! *parents' values* interpolate to, and a picture is made from the finest level's values alone.
//! The paper sums the levels' separately normalised functions instead (Eq. 6). Nesting makes the
//! flattening of section 4.1 exact and free, needs one level's functions at a ray's hit instead
//! of three, and turns Eq. 17's sum over all coarser levels into one over the parents' values.

mod evaluator;
mod relations;

pub use evaluator::{Evaluator, Leveled, Support};
pub use relations::Relations;
