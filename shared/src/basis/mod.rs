//! Data derived from the points alone: not stored in the file; baker and reader compute it by the same arithmetic.
//!
//! * [`Lookup`] – functions that may cover a place;
//! * [`Relations`] – parents and children.
//!
//! Levels are nested, unlike the paper's: a point's value is its coefficient plus the interpolation of its *parents'
//! values*, and a picture uses only the finest level's values. The paper sums the levels' separately normalised
//! functions instead (Eq. 6). Nesting makes the flattening of section 4.1 exact and free, needs one level's functions
//! at a ray's hit instead of three, and turns Eq. 17's sum over every coarser level into a sum over the parents'
//! values.

mod least_squares;
mod lookup;
mod relations;
#[cfg(feature = "radiosity")]
mod renewed;

pub use lookup::{LEVEL_WORDS, Lookup, LookupEntry};
pub use relations::{ParentWeights, Relations};
#[cfg(feature = "radiosity")]
pub use renewed::MostEntries;

use crate::rbn::bulk::{Cut, Point};
use crate::rbn::meta::Level;

/// Functions of all levels.
#[derive(Clone, Copy, Debug)]
pub struct Functions<'a> {
    /// Points, level after level.
    pub points: &'a [Point],
    /// Clip planes of all points.
    pub cuts: &'a [Cut],
    /// Levels, coarsest first.
    pub levels: &'a [Level],
    /// [Reconstruction group](crate::rbn::groups) of each point; empty where all are of group 0.
    pub groups: &'a [u32],
}

impl Functions<'_> {
    /// Reconstruction group of point `i`.
    #[inline]
    pub fn group_of(&self, i: usize) -> u32 {
        self.groups.get(i).copied().unwrap_or(0)
    }

    /// Number of points on the `levels` coarsest levels.
    fn count_on(&self, levels: usize) -> usize {
        let levels = &self.levels[..levels.min(self.levels.len())];
        levels.last().map_or(0, |last| (last.first + last.count) as usize)
    }
}
