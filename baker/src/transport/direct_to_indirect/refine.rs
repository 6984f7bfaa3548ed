//! The one-bounce operator T by adaptive refinement of the receivers (paper, Fig. 5).
//!
//! The queue of the paper goes level by level, so all receivers of one level can be gathered in
//! parallel: each reads only the links of coarser levels.

use super::bytes::{Reader, put_receivers};
use super::directions::Directions;
use super::gather::{Gather, Gathered, Scratch};
use super::gather_context::{GatherContext, GatherCost};
use super::hit_cache::{HitCache, Layout};
use super::journal::PartialResults;
use super::neighbourhood::SenderBlocks;
use super::{Operator, OperatorSettings, among, tint};
use crate::basis::{Leveled, Relations, sender_evaluator};
use crate::communicator::share::{SendBuffer, Traffic, share};
use crate::communicator::{Communicator, CommunicatorError};
use crate::geometry::Surfaces;
use crate::random::mix;
use crate::sampling::Points;
use crate::watch::{Stopped, Uncounted, Watch};
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

/// The functions that light leaves from.
pub struct Senders {
    all: Leveled,
    count: usize,
    coarse_count: usize,
    tiles: Option<HitCache>,
    duals: Vec<Vec3A>,
    blocks: SenderBlocks,
}

impl Senders {
    /// The senders among these points, with the points' [`tints`](tint::tints), and what rays find of them. A unit of
    /// `watch` is a tile.
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

    /// What gathers for these senders read.
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
    /// What the receivers so far have as a whole: [`Gathered::value`].
    values: Vec<Vec<Link>>,
    /// The next level.
    level: usize,
    /// The sum of each receiver's row: its irradiance where all senders have a unit of light.
    row_sums: Vec<f32>,
    /// What gathered receivers get where all senders have a unit of light: by their rays, of it where no function is, and by
    /// their rows.
    seen: f64,
    lost: f64,
    kept: f64,
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

    /// Whether a receiver of the next level is gathered for: children of receivers that kept a link, and those that no
    /// coarser function reaches; of far levels all, and theirs.
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

    /// Rays that the next level will cast.
    pub fn rays_ahead(&self) -> u64 {
        self.receivers_ahead().len() as u64 * self.context.settings.rays_on(self.level) as u64
    }

    /// Computes the next level together with the team. A unit of `watch` is a ray. What the first member's `journal` has
    /// is taken from there; the rest of the chunks go round the members, so that each gets its share of the costly ones.
    /// All rows are for the first member; the others get what the next level and later bounces read. How many bytes that
    /// took.
    ///
    /// # Errors
    /// [`CommunicatorError`]; the level is as if it had not been begun, but for what `journal` keeps.
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
        // All over the scene from the first to the last, so that what is done says how long the rest takes.
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
                // Only the first member has all of a row.
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
            // Nobody reads the rows that are not here.
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

    /// Once the coarse levels are computed: what their points get from each other, for later bounces. A unit of `watch` is such a
    /// point.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn relate_coarse(&mut self, watch: &dyn Watch) -> Result<(), Stopped> {
        let context = &self.context;
        let values = &self.values[..context.coarse_count];
        let tints = &self.operator.tints[..self.sender_count];
        self.operator.coarse = among(values, context.relations.push(), tints, context.settings, watch)?;
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

/// The chunks of one level, as far as they are known.
struct KnownRows {
    start: usize,
    end: usize,
    /// Receivers of a chunk; the last one may have fewer.
    size: usize,
    rows: Vec<Option<Vec<Gathered>>>,
}

impl KnownRows {
    fn new(Range { start, end }: Range<usize>, size: usize) -> Self {
        Self { start, end, size, rows: vec![None; (end - start).div_ceil(size)] }
    }

    /// The first receiver of a chunk, and how many there are.
    fn place(&self, chunk: usize) -> (usize, usize) {
        let first = self.start + chunk * self.size;
        (first, self.size.min(self.end - first))
    }

    /// Takes the rows of a chunk; `None` where they do not fit.
    fn set(&mut self, first: usize, rows: Vec<Gathered>) -> Option<()> {
        let chunk = first.checked_sub(self.start)? / self.size;
        let is_one = chunk < self.rows.len() && (first, rows.len()) == self.place(chunk);
        is_one.then(|| self.rows[chunk] = Some(rows))
    }

    /// The first member tells the others which chunks it has from an earlier run. How many bytes that took.
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

/// What all members read of some rows: not their links, but whether there are any.
fn for_others(rows: &[Gathered]) -> Vec<Gathered> {
    let of_one = |row: &Gathered| Gathered {
        links: row.links.first().copied().into_iter().collect(),
        value: row.value.clone(),
        cost: GatherCost::default(),
    };
    rows.iter().map(of_one).collect()
}

/// Sends some rows: links and cost to the first member, the rest to all where that is wanted.
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

/// Puts together what [`post`] sent; `None` where it is something else.
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
    // Both were posted in the same order.
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
