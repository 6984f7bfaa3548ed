//! The one-bounce operator T by adaptive refinement of the receivers (paper, Fig. 5).
//!
//! The queue of the paper goes level by level, so all receivers of one level can be gathered in
//! parallel: each reads only the links of coarser levels.

use super::directions::Directions;
use super::gather::{GatherContext, Gathered, Scratch};
use super::{Operator, OperatorSettings, tint};
use crate::basis::{Leveled, Relations, evaluator, sender_evaluator};
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
    let basis = |levels: usize| Leveled::new((0..levels).map(|l| evaluator(points, l)).collect());
    let sender_levels = settings.sender_levels.min(points.levels.len());
    let coarse_levels = settings.later_levels.min(sender_levels);
    let (sender_count, coarse_count) = (points.count_on(sender_levels), points.count_on(coarse_levels));
    let tints = tint::tints(surfaces, points, settings.seed);
    let mut operator = Operator { tints, bounces: 1, ..Operator::default() };
    let context = GatherContext {
        surfaces,
        points,
        relations,
        senders: &Leveled::new((0..sender_levels).map(|l| sender_evaluator(points, l)).collect()),
        coarse: &basis(coarse_levels),
        coarse_count,
        tints: &tint::unpack(&operator.tints),
        settings,
    };
    operator.links = vec![Vec::new(); points.points.len()];
    let mut values = vec![Vec::new(); points.points.len()];
    let (mut seen, mut lost) = (0.0, 0.0);
    let pool = Mutex::new(Vec::new());
    for (l, level) in points.levels.iter().enumerate() {
        let directions = Directions::new(settings.rays_on(l));
        let (done, refined) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let rows = &operator.links;
        // Children of receivers that kept a link; those that no coarser function reaches; and those
        // that later bounces need, whatever their parents kept.
        let is_wanted = |i: usize| {
            let parents = relations.push().row(i);
            i < coarse_count
                || parents.is_empty()
                || parents.iter().any(|parent| !rows[parent.point()].is_empty())
        };
        let known = &values;
        let indices: Vec<usize> = level.range().collect();
        let found: Vec<Gathered> = indices
            .par_chunks(64)
            .flat_map_iter(|chunk| {
                let recycled = pool.lock().ok().and_then(|mut free| free.pop());
                let mut scratch = recycled.unwrap_or_else(|| Scratch::new(sender_count, coarse_count));
                let gather = |&i: &usize| {
                    if is_wanted(i) {
                        refined.fetch_add(1, Ordering::Relaxed);
                        context.links(i, l, &directions, known, &mut scratch)
                    } else {
                        context.inherit(i, l, known, &mut scratch)
                    }
                };
                let out: Vec<_> = chunk.iter().map(gather).collect();
                if let Ok(mut free) = pool.lock() {
                    free.push(scratch);
                }
                let done = done.fetch_add(chunk.len(), Ordering::Relaxed) + chunk.len();
                progress(l, done, indices.len());
                out
            })
            .collect();
        operator.receivers += refined.into_inner() as u64;
        for (i, gathered) in indices.into_iter().zip(found) {
            operator.links[i] = gathered.links;
            values[i] = gathered.value;
            if i < coarse_count {
                operator.coarse.push(gathered.coarse);
            }
            operator.rays += gathered.cost.rays;
            seen += gathered.cost.seen;
            lost += gathered.cost.lost;
        }
    }
    operator.lost_share = if seen > 0.0 { lost / seen } else { 0.0 };
    operator
}
