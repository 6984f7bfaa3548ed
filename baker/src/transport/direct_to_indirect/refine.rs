//! The one-bounce operator T by adaptive refinement of the receivers (paper, Fig. 5).
//!
//! The paper's queue is processed level by level. The receivers of a level are gathered in
//! parallel, in chunks, because a receiver reads only the links of coarser levels.

use super::coarse_matrix::CoarseMatrix;
use super::directions::Directions;
use super::gather::{Gather, Gathered, Scratch};
use super::gather_context::GatherContext;
use super::pair_links::PairGather;
use super::pairwise::Pairwise;
use super::pairwise::handed::HandedLink;
use super::pairwise::quadrature::PLACES;
use super::senders::Senders;
use super::{Operator, OperatorSettings, Refinement, tint};
use crate::basis::Relations;
use crate::geometry::Surfaces;
use crate::sampling::Points;
use crate::transport::operator::IrradianceRow;
use rayon::prelude::*;
use rebounce_shared::interpolation::mean;
use rebounce_shared::link::Link;
use std::ops::Range;
use std::sync::Mutex;

/// Computes T, and the coarse transport matrix.
pub fn refine<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &Points,
    relations: &Relations,
    settings: &OperatorSettings,
) -> Operator {
    let tints = tint::tints(surfaces, points, settings.seed);
    let senders = Senders::unwatched(surfaces, points, settings, &tints);
    let pairwise = match settings.refinement {
        Refinement::Gather => None,
        #[cfg(feature = "pairwise")]
        Refinement::Pairwise => Pairwise::new(surfaces, points, relations, settings, &tints, &()).ok(),
    };
    let mut refiner = Refiner::new(surfaces, points, relations, settings, &senders, tints);
    refiner.set_pairwise(pairwise.as_ref());
    for _ in &points.levels {
        refiner.level();
    }
    let rows = refiner.coarse_matrix().rows();
    refiner.set_coarse(rows);
    refiner.finish()
}

/// Computes T level by level, coarsest first.
pub struct Refiner<'a, S: Surfaces + ?Sized> {
    context: GatherContext<'a, S>,
    sender_count: usize,
    operator: Operator,
    /// Values of the receivers of finished levels: [`Gathered::value`].
    values: Vec<Vec<Link>>,
    /// Set for pairwise links: their senders, and of finished levels what receivers [hand down](Gathered::handed).
    pairwise: Option<&'a Pairwise>,
    handed: Vec<Vec<HandedLink>>,
    /// The next level to compute.
    level: usize,
    /// Row sum of each receiver: the receiver's irradiance with unit light at all senders.
    row_sums: Vec<f32>,
    /// Total irradiance of gathered receivers with unit light at all senders: by their rays
    /// (`seen`), the part without a sender function (`lost`), and by their rows (`kept`).
    seen: f64,
    lost: f64,
    kept: f64,
}

impl<'a, S: Surfaces + ?Sized> Refiner<'a, S> {
    /// Creates a refiner with all levels still to compute.
    pub fn new(
        surfaces: &'a S,
        points: &'a Points,
        relations: &'a Relations,
        settings: &'a OperatorSettings,
        senders: &'a Senders,
        tints: Vec<u32>,
    ) -> Self {
        let context = senders.context(surfaces, points, relations, settings);
        let links = vec![Vec::new(); points.points.len()];
        Self {
            context,
            sender_count: senders.count,
            values: links.clone(),
            operator: Operator {
                links,
                tints,
                bounces: 1,
                reflected: settings.reflected,
                ..Operator::default()
            },
            pairwise: None,
            handed: vec![Vec::new(); points.points.len()],
            level: 0,
            row_sums: vec![0.0; points.points.len()],
            seen: 0.0,
            lost: 0.0,
            kept: 0.0,
        }
    }

    /// Refines [pairwise links](super::pairwise) instead of gathering rows, where `pairwise` is given.
    pub fn set_pairwise(&mut self, pairwise: Option<&'a Pairwise>) {
        self.pairwise = pairwise;
    }

    /// The pairwise links' senders; a constant without the feature `pairwise`, so that no code of it is left.
    fn pairwise(&self) -> Option<&'a Pairwise> {
        self.pairwise.filter(|_| cfg!(feature = "pairwise"))
    }

    /// Whether a receiver of the next level is gathered for: a child of a receiver with links, a
    /// receiver without parents, or any receiver of the far levels and of the level after the far
    /// levels. With pairwise links: a child of a receiver that hands links down, or a receiver without
    /// parents.
    fn is_wanted(&self, i: usize) -> bool {
        if self.pairwise().is_some() {
            let parents = self.context.relations.push().row(i);
            return parents.is_empty()
                || parents.iter().any(|parent| !self.handed[parent.point()].is_empty());
        }
        if self.level <= self.context.settings.far_levels && self.context.settings.far_levels > 0 {
            return true;
        }
        let parents = self.context.relations.push().row(i);
        parents.is_empty() || parents.iter().any(|parent| !self.operator.links[parent.point()].is_empty())
    }

    /// Receivers of the next level that are gathered for, ascending.
    pub fn receivers_ahead(&self) -> Vec<usize> {
        let level = self.context.points.levels.get(self.level).map_or(0..0, |level| level.range());
        level.into_par_iter().filter(|i| self.is_wanted(*i)).collect()
    }

    /// Number of rays to cast for the next level.
    pub fn rays_ahead(&self) -> u64 {
        let rays = self.context.settings.rays_on(self.level) as u64;
        let receivers = self.receivers_ahead();
        let Some(pairwise) = self.pairwise() else { return receivers.len() as u64 * rays };
        // About as many links as the parent with the most hands down, with all rays of both ends.
        let links = |i: &usize| {
            let parents = self.context.relations.push().row(*i);
            let most = parents.iter().map(|parent| self.handed[parent.point()].len()).max();
            2 * PLACES as u64 * most.unwrap_or(pairwise.root_count) as u64
                + if parents.is_empty() { rays } else { 0 }
        };
        receivers.par_iter().map(links).sum()
    }

    /// Returns the gathers of the next level, by chunk.
    pub fn next_level(&self) -> LevelGather<'_, 'a, S> {
        let range = self.context.points.levels.get(self.level).map_or(0..0, |level| level.range());
        let directions = Directions::new(self.context.settings.rays_on(self.level));
        LevelGather { refiner: self, range, directions, scratches: Mutex::default() }
    }

    /// Computes the next level.
    pub fn level(&mut self) {
        let chunks = self.next_level();
        let rows = (0..chunks.count()).into_par_iter().map(|chunk| chunks.gather(chunk)).collect();
        self.finish_level(rows);
    }

    /// Stores the results of the next level, a vector per chunk. A chunk may be empty if its results are never read.
    pub fn finish_level(&mut self, chunks: Vec<Vec<Gathered>>) {
        let Some(level) = self.context.points.levels.get(self.level) else { return };
        let (first, size) = (level.range().start, self.context.settings.chunk_on(self.level));
        for (chunk, rows) in chunks.into_iter().enumerate() {
            for (k, gathered) in rows.into_iter().enumerate() {
                self.take_in(first + chunk * size + k, gathered);
            }
        }
        if self.seen > 0.0 {
            self.operator.lost_share = self.lost / self.seen;
            self.operator.link_loss = 1.0 - self.operator.lost_share - self.kept / self.seen;
        }
        self.level += 1;
    }

    /// Returns the coarse transport matrix for later bounces, after the coarse levels.
    pub fn coarse_matrix(&self) -> CoarseMatrix<'_> {
        let context = &self.context;
        let values = &self.values[..context.coarse_count];
        let tints = &self.operator.tints[..self.sender_count];
        CoarseMatrix::new(values, context.relations.push(), tints, context.settings)
    }

    /// Stores the rows of the [coarse transport matrix](Self::coarse_matrix).
    pub fn set_coarse(&mut self, rows: Vec<IrradianceRow>) {
        self.operator.coarse = rows;
    }

    fn take_in(&mut self, i: usize, gathered: Gathered) {
        self.operator.receivers += (gathered.cost.rays > 0) as u64;
        self.operator.rays += gathered.cost.rays;
        self.seen += gathered.cost.seen;
        self.lost += gathered.cost.lost;
        let own: f32 = gathered.links.iter().map(|link| link.amount()).sum();
        let parents = mean(self.context.relations.push().row(i), 0.0, |parent| self.row_sums[parent]);
        self.row_sums[i] = own + parents.unwrap_or(0.0);
        if gathered.cost.rays > 0 {
            self.kept += self.row_sums[i] as f64;
        }
        self.operator.links[i] = gathered.links;
        self.values[i] = gathered.value;
        self.handed[i] = gathered.handed;
    }

    /// T of the levels computed so far.
    pub fn operator(&self) -> &Operator {
        &self.operator
    }

    /// T of the levels computed so far, mutable: later bounces can be added after the coarse
    /// levels.
    pub fn operator_mut(&mut self) -> &mut Operator {
        &mut self.operator
    }

    /// Returns T.
    pub fn finish(self) -> Operator {
        self.operator
    }
}

/// The gathers of a level, in chunks of neighbouring receivers. Chunks are independent.
pub struct LevelGather<'r, 'a, S: Surfaces + ?Sized> {
    refiner: &'r Refiner<'a, S>,
    range: Range<usize>,
    directions: Directions,
    /// Working memory, recycled between chunks.
    scratches: Mutex<Vec<Scratch>>,
}

impl<S: Surfaces + ?Sized> LevelGather<'_, '_, S> {
    /// Number of chunks.
    pub fn count(&self) -> usize {
        self.range.len().div_ceil(self.size())
    }

    /// Receivers of a chunk.
    pub fn receivers(&self, chunk: usize) -> Range<usize> {
        let first = self.range.start + chunk * self.size();
        first..self.range.end.min(first + self.size())
    }

    /// Whether later levels or later bounces read the results.
    pub fn is_read(&self) -> bool {
        let context = &self.refiner.context;
        self.refiner.level + 1 < context.points.levels.len() || self.range.start < context.coarse_count
    }

    /// Whether data of unknown origin is valid for a chunk.
    pub fn fits(&self, chunk: usize, rows: &[Gathered]) -> bool {
        rows.len() == self.receivers(chunk).len()
            && rows.iter().all(|gathered| gathered.fits(self.refiner.sender_count))
    }

    /// Computes the results of a chunk's receivers.
    pub fn gather(&self, chunk: usize) -> Vec<Gathered> {
        let (refiner, level) = (self.refiner, self.refiner.level);
        let recycled = self.scratches.lock().ok().and_then(|mut free| free.pop());
        let mut scratch = recycled.unwrap_or_else(|| Scratch::new(refiner.sender_count));
        let receivers = self.receivers(chunk);
        let (first, mut rows) = (receivers.start, vec![Gathered::default(); receivers.len()]);
        let (wanted, others): (Vec<usize>, Vec<usize>) = receivers.partition(|i| refiner.is_wanted(*i));
        let (directions, values) = (&self.directions, &refiner.values[..]);
        let done = |i: usize, gathered: Gathered| rows[i - first] = gathered;
        match refiner.pairwise() {
            None => {
                let gather = Gather { receivers: &wanted, level, directions, values };
                refiner.context.links(&gather, &mut scratch, done);
            }
            Some(pairwise) => {
                let (handed, row_sums) = (&refiner.handed[..], &refiner.row_sums[..]);
                let receivers = &wanted[..];
                let gather = PairGather { receivers, level, directions, values, handed, row_sums, pairwise };
                refiner.context.pair_links(&gather, &mut scratch, done);
            }
        }
        // With pairwise links, children read what is handed down and no values.
        let reads = |i: usize| refiner.pairwise().is_none() || i < refiner.context.coarse_count;
        for i in others.into_iter().filter(|i| reads(*i)) {
            rows[i - first] = refiner.context.inherit(i, level, values, &mut scratch);
        }
        if let Ok(mut free) = self.scratches.lock() {
            free.push(scratch);
        }
        rows
    }

    fn size(&self) -> usize {
        self.refiner.context.settings.chunk_on(self.refiner.level)
    }
}
