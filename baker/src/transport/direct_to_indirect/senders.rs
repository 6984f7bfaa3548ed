//! The senders of an operator: functions, tints, hit cache and blocks.

use super::gather_context::GatherContext;
use super::hit_cache::{HitCache, Layout};
use super::neighbourhood::SenderBlocks;
use super::tint;
use super::{OperatorSettings, Refinement};
use crate::basis::{Leveled, Relations, sender_evaluator};
use crate::geometry::Surfaces;
use crate::job::watch::{Stopped, Watch};
use crate::sampling::Points;
use glam::Vec3A;

/// The sender functions, their tints, hit cache and blocks.
pub struct Senders {
    all: Leveled,
    /// Number of senders.
    pub(super) count: usize,
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
        // Pairwise links meet no hit but those of the initial gather.
        let is_cached = settings.refinement == Refinement::Gather;
        let tiles = surfaces.primitives().filter(|_| is_cached).map(|pieces| {
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

    /// [`Self::new`] without progress.
    pub fn unwatched<S: Surfaces + ?Sized>(
        surfaces: &S,
        points: &Points,
        settings: &OperatorSettings,
        tints: &[u32],
    ) -> Self {
        match Self::new(surfaces, points, settings, tints, &()) {
            Ok(senders) => senders,
            Err(Stopped) => unreachable!("nobody stops an unwatched computation"),
        }
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
