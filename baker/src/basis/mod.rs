//! The basis: weight functions around points, normalised per level (paper, sections 2.1 and 2.2).
//!
//! [`Evaluator`] finds and weighs the functions that cover a place, fast; who is whose parent and child,
//! `rebounce_shared::basis` says.

mod evaluator;

use crate::sampling::Points;
pub use evaluator::{Evaluator, Leveled, Support};
use rebounce_shared::basis::ParentWeights;
pub use rebounce_shared::basis::Relations;
use rebounce_shared::rbn::RbnError;

/// Finds the relations of points; those of `direct_levels` levels but the last get children.
///
/// # Errors
/// [`RbnError`] where far too many functions lie in one place.
pub fn relate(points: &Points, direct_levels: usize) -> Result<Relations, RbnError> {
    let (records, cuts, levels) = points.records();
    Relations::new(&records, &cuts, &levels, direct_levels, ParentWeights::default())
}

/// Support over disk radius of a function that takes what a ray finds: narrow, so that the direct
/// light at its point is blurred little and few functions share a hit.
const SENDER_OVERLAP: f32 = 1.25;

/// The evaluator of one level of senders.
pub fn sender_evaluator(points: &Points, level: usize) -> Evaluator {
    let level = &points.levels[level];
    let radius = SENDER_OVERLAP * level.disk_radius;
    let support = |i: usize| {
        let p = &points.points[i];
        Support { position: p.position, normal: p.normal, radius, cuts: points.cuts_of(i) }
    };
    Evaluator::new(level.range().map(support), level.first as u32)
}
