//! The one-bounce operator T by adaptive refinement of the receivers (paper, Fig. 5).
//!
//! The paper's queue is processed level by level. The receivers of a level are gathered in
//! parallel, because a receiver reads only the links of coarser levels.

use super::bytes::{Reader, put_receivers};
use super::directions::Directions;
use super::gather::{Gather, Gathered, Scratch};
use super::gather_context::{GatherContext, GatherCost};
use super::hit_cache::{HitCache, Layout};
use super::journal::PartialResults;
use super::neighbourhood::SenderBlocks;
use super::{Operator, OperatorSettings, coarse_rows, tint};
use crate::basis::{Leveled, Relations, sender_evaluator};
use crate::geometry::Surfaces;
use crate::job::communicator::share::{SendBuffer, Traffic, share};
use crate::job::communicator::{Communicator, CommunicatorError};
use crate::job::watch::{Stopped, Uncounted, Watch};
use crate::random::mix;
use crate::sampling::Points;
use glam::Vec3A;
use rayon::prelude::*;
use rebounce_shared::interpolation::mean;
use rebounce_shared::link::Link;
use std::ops::Range;
use std::sync::Mutex;

/// Computes T. A unit of `watch` is a ray.
///
/// # Errors
/// [`CommunicatorError::Stopped`].
pub fn refine<S: Surfaces + ?Sized>(
    surfaces: &S,
    points: &Points,
    relations: &Relations,
    settings: &OperatorSettings,
    watch: &dyn Watch,
) -> Result<Operator, CommunicatorError> {
    let tints = tint::tints(surfaces, points, settings.seed, &())?;
    let senders = Senders::new(surfaces, points, settings, &tints, &Uncounted(watch))?;
    let mut refiner = Refiner::new(surfaces, points, relations, settings, &senders, tints);
    for _ in &points.levels {
        refiner.level(watch, &(), &())?;
    }
    refiner.relate_coarse(&Uncounted(watch))?;
    Ok(refiner.finish())
}

/// The sender functions, their tints, hit cache and blocks.
pub struct Senders {
    all: Leveled,
    count: usize,
    coarse_count: usize,
    tiles: Option<HitCache>,
    duals: Vec<Vec3A>,
    blocks: SenderBlocks,
}

impl Senders {
    /// Builds the evaluators, hit cache and blocks of the senders among `points`. `tints` are the
    /// points' [`tints`](tint::tints). A unit of `watch` is a tile.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn new<S: Surfaces + ?Sized>(
        surfaces: &S,
        points: &Points,
        settings: &OperatorSettings,
        tints: &[u32],
        watch: &dyn Watch,
    ) -> Result<Self, Stopped> {
        let levels = settings.sender_levels.min(points.levels.len());
        let coarse_levels = settings.later_levels.min(levels);
        let all = Leveled::new((0..levels).map(|l| sender_evaluator(points, l)).collect());
        let duals = tint::duals(tints);
        let tiles = surfaces.primitives().map(|pieces| {
            let layout = Layout::new(pieces, &all, duals.len(), watch)?;
            watch.expect(layout.count() as u64);
            HitCache::on(layout, pieces, &all, &duals, settings.seed, watch)
        });
        Ok(Self {
            all,
            count: points.count_on(levels),
            coarse_count: points.count_on(coarse_levels),
            tiles: tiles.transpose()?,
            duals,
            blocks: SenderBlocks::new(points, points.count_on(levels)),
        })
    }

    /// Returns the input of gathers for these senders.
    pub fn context<'a, S: Surfaces + ?Sized>(
        &'a self,
        surfaces: &'a S,
        points: &'a Points,
        relations: &'a Relations,
        settings: &'a OperatorSettings,
    ) -> GatherContext<'a, S> {
        GatherContext {
            surfaces,
            points,
            relations,
            senders: &self.all,
            coarse_count: self.coarse_count,
            tiles: self.tiles.as_ref(),
            duals: &self.duals,
            sender_blocks: &self.blocks,
            settings,
        }
    }
}

/// Computes T level by level, coarsest first.
pub struct Refiner<'a, S: Surfaces + ?Sized> {
    context: GatherContext<'a, S>,
    sender_count: usize,
    operator: Operator,
    /// Values of the receivers of finished levels: [`Gathered::value`].
    values: Vec<Vec<Link>>,
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
            operator: Operator { links, tints, bounces: 1, ..Operator::default() },
            level: 0,
            row_sums: vec![0.0; points.points.len()],
            seen: 0.0,
            lost: 0.0,
            kept: 0.0,
        }
    }

    /// Whether a receiver of the next level is gathered for: a child of a receiver with links, a
    /// receiver without parents, or any receiver of the far levels and of the level after the far
    /// levels.
    fn is_wanted(&self, i: usize) -> bool {
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
        self.receivers_ahead().len() as u64 * self.context.settings.rays_on(self.level) as u64
    }

    /// Computes the next level with all processes of the communicator and returns the number of
    /// bytes sent. A unit of `watch` is a ray. Chunks in the first process's `journal` are read
    /// from the journal; the remaining chunks are dealt to the processes in turn, so that costly
    /// chunks are spread evenly. The first process receives all rows; the other processes receive
    /// only the data for the next level and later bounces.
    ///
    /// # Errors
    /// [`CommunicatorError`]; the level stays uncomputed, except for chunks in `journal`.
    pub fn level(
        &mut self,
        watch: &dyn Watch,
        journal: &dyn PartialResults,
        team: &dyn Communicator,
    ) -> Result<Traffic, CommunicatorError> {
        let (context, l) = (&self.context, self.level);
        let Some(level) = context.points.levels.get(l) else { return Ok(Traffic::default()) };
        let range = level.range();
        let mut found = KnownRows::new(range.clone(), context.settings.chunk_on(l));
        let mut traffic = Traffic::default();
        for chunk in 0..found.rows.len() {
            let (first, count) = found.place(chunk);
            let fits = |rows: &Vec<Gathered>| rows.iter().all(|gathered| gathered.fits(self.sender_count));
            if let Some(rows) = journal.receivers(first, count).filter(fits) {
                watch.skip(rows.iter().map(|gathered| gathered.cost.rays).sum())?;
                found.rows[chunk] = Some(rows);
            }
        }
        if team.size() > 1 {
            traffic.to_all += found.announce(team, watch)?;
        }
        let for_all = l + 1 < context.points.levels.len() || range.start < context.coarse_count;
        let left = (0..found.rows.len()).filter(|chunk| found.rows[*chunk].is_none());
        let mut mine: Vec<(usize, usize)> =
            left.skip(team.rank()).step_by(team.size()).map(|chunk| found.place(chunk)).collect();
        // In random order over the scene, so that progress predicts the remaining time.
        mine.sort_by_key(|(first, _)| mix(*first as u64));
        let directions = Directions::new(context.settings.rays_on(l));
        let pool = Mutex::new(Vec::new());
        let this = &*self;
        let work = |outbox: Option<&SendBuffer>| {
            let gather_chunk = |&(first, count): &(usize, usize)| {
                let recycled = pool.lock().ok().and_then(|mut free| free.pop());
                let mut scratch = recycled.unwrap_or_else(|| Scratch::new(this.sender_count));
                let (wanted, others): (Vec<usize>, Vec<usize>) =
                    (first..first + count).partition(|i| this.is_wanted(*i));
                let mut rows = vec![Gathered::default(); count];
                let cast = |rays| watch.step(rays);
                let done = |i: usize, gathered| rows[i - first] = gathered;
                let (directions, values) = (&directions, &this.values[..]);
                let gather = Gather { receivers: &wanted, level: l, directions, values };
                context.links(&gather, &mut scratch, cast, done)?;
                for i in others {
                    rows[i - first] = context.inherit(i, l, &this.values, &mut scratch);
                    watch.step(0)?;
                }
                if let Ok(mut free) = pool.lock() {
                    free.push(scratch);
                }
                journal.keep_receivers(first, &rows);
                if let Some(outbox) = outbox {
                    post(outbox, first, &rows, for_all);
                }
                Ok((first, rows))
            };
            mine.par_iter().map(gather_chunk).collect::<Result<Vec<_>, Stopped>>()
        };
        let arrive = |member: usize, for_first: &[u8], for_all: &[u8]| {
            for (first, rows) in join(for_first, for_all).ok_or(CommunicatorError::Garbled(member))? {
                let rays = rows.iter().map(|gathered| gathered.cost.rays).sum();
                // Only the first process has complete rows.
                if team.rank() == 0 {
                    journal.keep_receivers(first, &rows);
                }
                found.set(first, rows).ok_or(CommunicatorError::Garbled(member))?;
                watch.step(rays)?;
            }
            Ok(())
        };
        let (own, sent) = share(team, watch, work, arrive)?;
        traffic.add(sent);
        for (first, rows) in own {
            found.set(first, rows).ok_or(CommunicatorError::Garbled(team.rank()))?;
        }
        if !for_all && team.rank() != 0 {
            // The missing rows are never read on this process.
            found.rows.iter_mut().for_each(|rows| *rows = rows.take().or(Some(Vec::new())));
        }
        let rows = found.rows.into_iter().collect::<Option<Vec<_>>>().ok_or(CommunicatorError::Garbled(0))?;
        let size = self.context.settings.chunk_on(l);
        for (number, rows) in rows.into_iter().enumerate() {
            for (k, gathered) in rows.into_iter().enumerate() {
                self.take_in(range.start + number * size + k, gathered);
            }
        }
        if self.seen > 0.0 {
            self.operator.lost_share = self.lost / self.seen;
            self.operator.link_loss = 1.0 - self.operator.lost_share - self.kept / self.seen;
        }
        self.level += 1;
        Ok(traffic)
    }

    /// Computes the coarse transport matrix for later bounces, after the coarse levels. A unit of
    /// `watch` is a coarse point.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn relate_coarse(&mut self, watch: &dyn Watch) -> Result<(), Stopped> {
        let context = &self.context;
        let values = &self.values[..context.coarse_count];
        let tints = &self.operator.tints[..self.sender_count];
        self.operator.coarse = coarse_rows(values, context.relations.push(), tints, context.settings, watch)?;
        Ok(())
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

/// Chunks of a level; `None` for chunks that are not known yet.
struct KnownRows {
    start: usize,
    end: usize,
    /// Receivers per chunk; the last chunk may have fewer.
    size: usize,
    rows: Vec<Option<Vec<Gathered>>>,
}

impl KnownRows {
    fn new(Range { start, end }: Range<usize>, size: usize) -> Self {
        Self { start, end, size, rows: vec![None; (end - start).div_ceil(size)] }
    }

    /// First receiver and number of receivers of a chunk.
    fn place(&self, chunk: usize) -> (usize, usize) {
        let first = self.start + chunk * self.size;
        (first, self.size.min(self.end - first))
    }

    /// Stores the rows of a chunk; returns `None` if `first` and the number of rows match no chunk.
    fn set(&mut self, first: usize, rows: Vec<Gathered>) -> Option<()> {
        let chunk = first.checked_sub(self.start)? / self.size;
        let is_one = chunk < self.rows.len() && (first, rows.len()) == self.place(chunk);
        is_one.then(|| self.rows[chunk] = Some(rows))
    }

    /// Sends the first process's known chunks (from an earlier run) to the other processes. Returns
    /// the number of bytes.
    fn announce(&mut self, team: &dyn Communicator, watch: &dyn Watch) -> Result<u64, CommunicatorError> {
        let mut known = Vec::new();
        if team.rank() == 0 {
            for (chunk, rows) in self.rows.iter().enumerate() {
                if let Some(rows) = rows {
                    put_receivers(&mut known, self.place(chunk).0, &for_others(rows));
                }
            }
        }
        let received = team.exchange(&[], &known, watch)?;
        let told = received.to_all.first().ok_or(CommunicatorError::Garbled(0))?;
        if team.rank() != 0 {
            for (first, rows) in join(&[], told).ok_or(CommunicatorError::Garbled(0))? {
                self.set(first, rows).ok_or(CommunicatorError::Garbled(0))?;
            }
        }
        Ok(told.len() as u64)
    }
}

/// Part of the rows for all processes: the values, and the first link as a flag for non-empty
/// links.
fn for_others(rows: &[Gathered]) -> Vec<Gathered> {
    let of_one = |row: &Gathered| Gathered {
        links: row.links.first().copied().into_iter().collect(),
        value: row.value.clone(),
        cost: GatherCost::default(),
    };
    rows.iter().map(of_one).collect()
}

/// Sends rows: links and cost to the first process, and the part [`for_others`] to all processes if
/// `for_all`.
fn post(outbox: &SendBuffer, first: usize, rows: &[Gathered], for_all: bool) {
    let of_one =
        |row: &Gathered| Gathered { links: row.links.clone(), cost: row.cost, ..Gathered::default() };
    let for_first: Vec<Gathered> = rows.iter().map(of_one).collect();
    outbox.post(|to_first, to_all| {
        put_receivers(to_first, first, &for_first);
        if for_all {
            put_receivers(to_all, first, &for_others(rows));
        }
    });
}

/// Joins the two parts of rows sent by [`post`]; `None` for malformed or mismatched bytes.
fn join(for_first: &[u8], for_all: &[u8]) -> Option<Vec<(usize, Vec<Gathered>)>> {
    let read = |bytes: &[u8]| {
        let mut from = Reader(bytes);
        let mut chunks = Vec::new();
        while !from.is_empty() {
            chunks.push(from.receivers()?);
        }
        Some(chunks)
    };
    let (mut whole, others) = (read(for_first)?, read(for_all)?);
    if whole.is_empty() || others.is_empty() {
        return Some(if whole.is_empty() { others } else { whole });
    }
    if whole.len() != others.len() {
        return None;
    }
    // Both parts were posted in the same order.
    for ((first, rows), (same, more)) in whole.iter_mut().zip(others) {
        if *first != same || rows.len() != more.len() {
            return None;
        }
        for (row, more) in rows.iter_mut().zip(more) {
            row.value = more.value;
        }
    }
    Some(whole)
}
