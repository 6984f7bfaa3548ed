//! The one-bounce operator T by adaptive refinement of the receivers (paper, Fig. 5).
//!
//! The queue of the paper goes level by level, so all receivers of one level can be gathered in
//! parallel: each reads only the links of coarser levels.

use super::directions::Directions;
use super::gather::{GatherContext, Gathered, Scratch};
use super::journal::Journal;
use super::{Operator, OperatorSettings, tint};
use crate::basis::{Leveled, Relations, evaluator, sender_evaluator};
use crate::points::Points;
use crate::surface::Surfaces;
use crate::watch::{Stopped, Watch};
use glam::Vec3A;
use rayon::prelude::*;
use rebounce_shared::link::Link;
use std::sync::Mutex;

/// Receivers that are gathered one after another by one thread, and kept together.
pub const CHUNK: usize = 64;

/// Computes T. A unit of `watch` is a ray.
///
/// # Errors
/// [`Stopped`].
pub fn refine<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &Points,
    relations: &Relations,
    settings: &OperatorSettings,
    watch: &dyn Watch,
) -> Result<Operator, Stopped> {
    let tints = tint::tints(surfaces, points, settings.seed, &())?;
    let senders = Senders::new(points, settings, &tints);
    let mut refiner = Refiner::new(surfaces, points, relations, settings, &senders, tints);
    for _ in &points.levels {
        refiner.level(watch, &())?;
    }
    Ok(refiner.finish())
}

/// The functions that light leaves from.
pub struct Senders {
    all: Leveled,
    coarse: Leveled,
    count: usize,
    coarse_count: usize,
    duals: Vec<Vec3A>,
}

impl Senders {
    /// The senders among these points, with the points' [`tints`](tint::tints).
    pub fn new(points: &Points, settings: &OperatorSettings, tints: &[u32]) -> Self {
        let levels = settings.sender_levels.min(points.levels.len());
        let coarse_levels = settings.later_levels.min(levels);
        Self {
            all: Leveled::new((0..levels).map(|l| sender_evaluator(points, l)).collect()),
            coarse: Leveled::new((0..coarse_levels).map(|l| evaluator(points, l)).collect()),
            count: points.count_on(levels),
            coarse_count: points.count_on(coarse_levels),
            duals: tint::duals(tints),
        }
    }
}

/// Computes T level by level, coarsest first.
pub struct Refiner<'a, S: Surfaces + ?Sized> {
    context: GatherContext<'a, S>,
    sender_count: usize,
    operator: Operator,
    /// What the receivers so far have as a whole: [`Gathered::value`].
    values: Vec<Vec<Link>>,
    /// The next level.
    level: usize,
    seen: f64,
    lost: f64,
}

impl<'a, S: Surfaces + ?Sized> Refiner<'a, S> {
    /// Nothing is computed yet.
    pub fn new(
        surfaces: &'a S,
        points: &'a Points,
        relations: &'a Relations,
        settings: &'a OperatorSettings,
        senders: &'a Senders,
        tints: Vec<u32>,
    ) -> Self {
        let context = GatherContext {
            surfaces,
            points,
            relations,
            senders: &senders.all,
            coarse: &senders.coarse,
            coarse_count: senders.coarse_count,
            duals: &senders.duals,
            settings,
        };
        let links = vec![Vec::new(); points.points.len()];
        Self {
            context,
            sender_count: senders.count,
            values: links.clone(),
            operator: Operator { links, tints, bounces: 1, ..Operator::default() },
            level: 0,
            seen: 0.0,
            lost: 0.0,
        }
    }

    /// Whether a receiver of the next level is gathered for: children of receivers that kept a link; those that no
    /// coarser function reaches; and those that later bounces need, whatever their parents kept.
    fn is_wanted(&self, i: usize) -> bool {
        let parents = self.context.relations.push().row(i);
        i < self.context.coarse_count
            || parents.is_empty()
            || parents.iter().any(|parent| !self.operator.links[parent.point()].is_empty())
    }

    /// Rays that the next level will cast.
    pub fn rays_ahead(&self) -> u64 {
        let Some(level) = self.context.points.levels.get(self.level) else { return 0 };
        let wanted = level.range().into_par_iter().filter(|i| self.is_wanted(*i)).count();
        wanted as u64 * self.context.settings.rays_on(self.level) as u64
    }

    /// Computes the next level. A unit of `watch` is a ray. What `journal` has is taken from there.
    ///
    /// # Errors
    /// [`Stopped`]; the level is as if it had not been begun, but for what `journal` keeps.
    pub fn level(&mut self, watch: &dyn Watch, journal: &dyn Journal) -> Result<(), Stopped> {
        let (context, l) = (&self.context, self.level);
        let Some(level) = context.points.levels.get(l) else { return Ok(()) };
        let directions = Directions::new(context.settings.rays_on(l));
        let pool = Mutex::new(Vec::new());
        let indices: Vec<usize> = level.range().collect();
        let chunks: Vec<Vec<Gathered>> = indices
            .par_chunks(CHUNK)
            .map(|chunk| {
                if let Some(found) = journal.receivers(chunk[0], chunk.len()) {
                    watch.skip(found.iter().map(|gathered| gathered.cost.rays).sum())?;
                    return Ok(found);
                }
                let recycled = pool.lock().ok().and_then(|mut free| free.pop());
                let mut scratch =
                    recycled.unwrap_or_else(|| Scratch::new(self.sender_count, context.coarse_count));
                let mut gather = |&i: &usize| {
                    let gathered = if self.is_wanted(i) {
                        context.links(i, l, &directions, &self.values, &mut scratch)
                    } else {
                        context.inherit(i, l, &self.values, &mut scratch)
                    };
                    watch.step(gathered.cost.rays)?;
                    Ok(gathered)
                };
                let found = chunk.iter().map(&mut gather).collect::<Result<Vec<_>, Stopped>>()?;
                if let Ok(mut free) = pool.lock() {
                    free.push(scratch);
                }
                journal.keep_receivers(chunk[0], &found);
                Ok(found)
            })
            .collect::<Result<_, Stopped>>()?;
        for (i, gathered) in indices.into_iter().zip(chunks.into_iter().flatten()) {
            self.operator.receivers += (gathered.cost.rays > 0) as u64;
            self.operator.rays += gathered.cost.rays;
            self.seen += gathered.cost.seen;
            self.lost += gathered.cost.lost;
            if i < self.context.coarse_count {
                self.operator.coarse.push(gathered.coarse);
            }
            self.operator.links[i] = gathered.links;
            self.values[i] = gathered.value;
        }
        self.operator.lost_share = if self.seen > 0.0 { self.lost / self.seen } else { 0.0 };
        self.level += 1;
        Ok(())
    }

    /// T so far.
    pub fn operator(&self) -> &Operator {
        &self.operator
    }

    /// T so far, for later bounces to be added once the coarse levels are done.
    pub fn operator_mut(&mut self) -> &mut Operator {
        &mut self.operator
    }

    /// T.
    pub fn finish(self) -> Operator {
        self.operator
    }
}
