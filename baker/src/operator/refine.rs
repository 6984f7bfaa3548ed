//! The one-bounce operator T by adaptive refinement of the receivers (paper, Fig. 5).
//!
//! The queue of the paper goes level by level, so all receivers of one level can be gathered in
//! parallel: each reads only the links of coarser levels.

use super::directions::Directions;
use super::gather::{GatherContext, Gathered, Scratch, link_directions};
use super::{Operator, OperatorSettings};
use crate::basis::{Evaluator, Leveled, Relations, evaluator};
use crate::points::Points;
use crate::surface::Surfaces;
use rayon::prelude::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Computes T. `progress` is told the level, the receivers done there and their number.
pub fn refine<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &Points,
    relations: &Relations,
    settings: &OperatorSettings,
    progress: &(impl Fn(usize, usize, usize) + Sync),
) -> Operator {
    let sender_levels = settings.sender_levels.clamp(1, points.levels.len().max(1)).min(points.levels.len());
    let senders = Leveled::new((0..sender_levels).map(|l| evaluator(points, l)).collect::<Vec<Evaluator>>());
    let mut firsts: Vec<usize> = points.levels[..sender_levels].iter().map(|l| l.first).collect();
    let sender_count = points.levels[..sender_levels].last().map_or(0, |l| l.range().end);
    firsts.push(sender_count);
    let link_directions = link_directions();
    let context = GatherContext {
        surfaces,
        points,
        relations,
        senders: &senders,
        sender_levels: &firsts,
        settings,
        link_directions: &link_directions,
    };
    let mut operator = Operator {
        rows: vec![Vec::new(); points.points.len()],
        irradiance: vec![Vec::new(); sender_count],
        bounces: 1,
        ..Operator::default()
    };
    let (mut seen, mut lost) = (0.0, 0.0);
    let pool = Mutex::new(Vec::new());
    for (l, level) in points.levels.iter().enumerate() {
        // Children of receivers that kept a link; and those that no coarser function reaches.
        let wanted: Vec<usize> = level
            .range()
            .filter(|&i| {
                let parents = relations.push().row(i);
                // Senders need their irradiance for later bounces, whatever their parents kept.
                i < sender_count
                    || parents.is_empty()
                    || parents.iter().any(|p| !operator.rows[p.point()].is_empty())
            })
            .collect();
        let directions = Directions::new(settings.rays_on(l));
        let done = AtomicUsize::new(0);
        let rows = &operator.rows;
        let found: Vec<Gathered> = wanted
            .par_chunks(64)
            .flat_map_iter(|chunk| {
                let recycled = pool.lock().ok().and_then(|mut free| free.pop());
                let mut scratch = recycled.unwrap_or_else(|| {
                    Scratch::new(sender_count, sender_levels, points.points.len(), points.levels.len())
                });
                let out: Vec<_> =
                    chunk.iter().map(|&i| context.links(i, l, &directions, rows, &mut scratch)).collect();
                if let Ok(mut free) = pool.lock() {
                    free.push(scratch);
                }
                let done = done.fetch_add(chunk.len(), Ordering::Relaxed) + chunk.len();
                progress(l, done, wanted.len());
                out
            })
            .collect();
        operator.receivers += wanted.len() as u64;
        for (&i, gathered) in wanted.iter().zip(found) {
            operator.rows[i] = gathered.links;
            if i < sender_count {
                operator.irradiance[i] = gathered.irradiance;
            }
            operator.rays += gathered.cost.rays;
            seen += gathered.cost.seen;
            lost += gathered.cost.lost;
        }
    }
    operator.lost_share = if seen > 0.0 { lost / seen } else { 0.0 };
    operator
}
