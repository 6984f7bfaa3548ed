//! The basis: weight functions around points, normalised per level (paper, sections 2.1 and 2.2).
//!
//! [`Evaluator`] finds the functions that cover a position and evaluates their weights.
//! `rebounce_shared::basis` computes parents and children.

mod evaluator;

use crate::sampling::Points;
pub use evaluator::{CoveringLevel, Evaluator, FetchStep, Leveled, Support};
pub use rebounce_shared::basis::Relations;
use rebounce_shared::basis::{Functions, ParentWeights};
use rebounce_shared::rbn::RbnError;

/// Computes parents and children of points. Points of the first `direct_levels` levels, except the
/// last of these levels, have children.
///
/// # Errors
/// [`RbnError`] if too many functions overlap at a position.
pub fn relate(points: &Points, direct_levels: usize) -> Result<Relations, RbnError> {
    let (records, cuts, levels) = points.records();
    let groups = points.groups();
    let functions = Functions { points: &records, cuts: &cuts, levels: &levels, groups: &groups };
    Relations::new(&functions, direct_levels, ParentWeights::default())
}

/// Ratio of support radius to disk radius for sender functions: narrow, so that direct light at a
/// point is blurred little and few functions cover a hit.
pub(crate) const SENDER_OVERLAP: f32 = 1.25;

/// Builds the evaluator of a sender level.
pub fn sender_evaluator(points: &Points, level: usize) -> Evaluator {
    let level = &points.levels[level];
    let support = |i: usize| {
        let p = &points.points[i];
        let radius = SENDER_OVERLAP * level.disk_radius * points.scale(p.group);
        Support { position: p.position, normal: p.normal, radius, cuts: points.cuts_of(i), group: p.group }
    };
    Evaluator::new(level.range().map(support), level.first as u32)
}
