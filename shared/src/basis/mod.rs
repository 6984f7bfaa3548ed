//! What follows from the points alone: the file does not hold it, baker and reader work it out by the same arithmetic.
//!
//! * [`Lookup`] says which functions may cover a place;
//! * [`Relations`] says who is whose parent and child.
//!
//! Levels are nested here, unlike the paper's: a point's value is its coefficient plus what its
//! *parents' values* interpolate to, and a picture is made from the finest level's values alone.
//! The paper sums the levels' separately normalised functions instead (Eq. 6). Nesting makes the
//! flattening of section 4.1 exact and free, needs one level's functions at a ray's hit instead
//! of three, and turns Eq. 17's sum over all coarser levels into one over the parents' values.

mod least_squares;
mod lookup;
mod relations;

pub use lookup::{LEVEL_WORDS, Lookup};
pub use relations::{ParentWeights, Relations};
