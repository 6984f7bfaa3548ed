//! The basis over the baker's points; `rebounce_shared::basis` has the functions and their relations.

use crate::points::{PointLevel, Points};
pub use rebounce_shared::basis::{Evaluator, Leveled, Relations, Support};
use rebounce_shared::rbn::RbnError;

/// Finds the relations of points; those of `direct_levels` levels but the last get children.
///
/// # Errors
/// [`RbnError`] where far too many functions lie in one place.
pub fn relate(points: &Points, direct_levels: usize) -> Result<Relations, RbnError> {
    let (records, cuts, levels) = points.records();
    Relations::new(&records, &cuts, &levels, direct_levels)
}

/// The evaluator of one level.
pub(crate) fn evaluator(points: &Points, level: usize) -> Evaluator {
    let level = &points.levels[level];
    with_supports(points, level, level.support_radius)
}

/// Support over disk radius of a function that takes what a ray finds: narrow, so that the direct
/// light at its point is blurred little and few functions share a hit.
const SENDER_OVERLAP: f32 = 1.25;

/// The evaluator of one level of senders.
pub(crate) fn sender_evaluator(points: &Points, level: usize) -> Evaluator {
    let level = &points.levels[level];
    with_supports(points, level, SENDER_OVERLAP * level.disk_radius)
}

fn with_supports(points: &Points, level: &PointLevel, radius: f32) -> Evaluator {
    let support = |i: usize| {
        let p = &points.points[i];
        Support { position: p.position, normal: p.normal, radius, cuts: points.cuts_of(i) }
    };
    Evaluator::new(level.range().map(support), level.first as u32)
}
