//! A bake's stages in order: points, basis, operator, file.

use super::agree::agree;
use super::assemble::assemble;
use super::stand_in::Staged;
use super::tracker::Tracker;
use super::{BakeError, BakeReport, BakeSettings, Checkpoint, Observer, Preview, Stage};
use crate::basis::{Relations, relate};
use crate::geometry::mesh::TriangleSurfaces;
use crate::job::communicator::Communicator;
use crate::job::watch::{Uncounted, Watch};
use crate::light::direct::at_footprint;
use crate::sampling::emitter::ParticleEmitter;
use crate::sampling::{Placer, Points, cut, footprint, openness, place};
use crate::scene::Scene;
use crate::transport::direct_to_indirect::bounces::{add_later_bounces, column_count};
use crate::transport::direct_to_indirect::journal::PartialResults;
use crate::transport::direct_to_indirect::refine::{Refiner, Senders, refine};
use crate::transport::direct_to_indirect::{Operator, mean_albedo::reflected_share, tint};
use glam::Vec3;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::link::MAX_SENDERS;
use rebounce_shared::rbn::bulk::MAX_ALL_CUTS;

/// Number of points per checkpoint record of cuts and samples.
const SHAPED: usize = 1 << 15;
/// Number of coarse levels used to test whether any point is lit.
const LIT_LEVELS: usize = 4;
/// Maximum number of points for later bounces in a scene with graded point density; the number of levels for later
/// bounces is lowered to meet the maximum, as far as possible.
const MOST_LATER: usize = 6_000;
/// Functions on the finest level of a sketch, levels, and rays per receiver.
const SKETCH: (usize, usize, u32) = (3_000, 3, 512);

/// Inputs of all stages.
pub(super) struct Transport<'a> {
    pub scene: &'a Scene,
    pub surfaces: &'a TriangleSurfaces,
    pub vantage: &'a ParticleEmitter,
    pub staged: &'a Staged,
    pub observer: &'a dyn Observer,
    pub team: &'a dyn Communicator,
}

/// Returns the settings of a coarse first bake; `None` if the bake itself is small.
pub(super) fn sketch_settings(settings: &BakeSettings) -> Option<BakeSettings> {
    let (functions, levels, rays) = SKETCH;
    let mut sketch = settings.clone();
    sketch.place.coarse_radius = None;
    (sketch.place.functions, sketch.place.levels) = (functions, levels);
    sketch.operator.rays = vec![rays];
    (sketch.operator.sender_levels, sketch.direct_levels) = (levels, levels);
    // Later bounces cost the square of the number of points on their levels.
    sketch.operator.later_levels = 1;
    let is_small = settings.place.functions < 5 * functions || settings.place.levels <= levels;
    (!is_small).then(|| sketch.normalised())
}

impl Transport<'_> {
    /// Bakes coarsely and hands the result to the observer as a preview.
    pub(super) fn sketch(&self, mut settings: BakeSettings, watch: &dyn Watch) -> Result<(), BakeError> {
        let watch = &Uncounted(watch);
        let mut points = place(self.surfaces, self.vantage, &settings.place, watch)?;
        let far = points.levels.len() - settings.place.levels;
        settings = settings.deepened(points.levels.len());
        let end = points.points.len();
        cut(self.surfaces, &mut points, end, watch)?;
        footprint(self.surfaces, &mut points, end, watch)?;
        let relations = relate(&points, settings.direct_levels)?;
        settings.operator.reflected = reflected_share(self.surfaces, &points, far, settings.operator.seed);
        let mut operator = refine(self.surfaces, &points, &relations, &settings.operator, watch)?;
        add_later_bounces(&mut operator, &settings.operator, watch, &(), &())?;
        let file = self.file(&settings, &points, &relations, &operator)?;
        self.observer.preview(Preview { file, levels: 0 });
        Ok(())
    }

    /// Bakes; returns the result on the first member of the team, `None` on the others.
    pub(super) fn run(
        &self,
        mut settings: BakeSettings,
        tracker: &Tracker,
        checkpoint: Option<&Checkpoint>,
        mut report: BakeReport,
    ) -> Result<Option<(BakedScene, BakeReport)>, BakeError> {
        report.processes = self.team.size() as u64;
        let asked = settings.clone();
        let journal: &dyn PartialResults = checkpoint.map_or(&(), |checkpoint| checkpoint);
        let place = settings.place.clone();
        let placer = Placer::new(self.surfaces, self.vantage, &place)?;
        let far = placer.levels().saturating_sub(place.levels);
        if far > 0 {
            settings = settings.deepened(placer.levels());
            tracker.expect(|estimate| estimate.found_levels(&settings));
        }
        let mut points = self.points(placer, &settings, tracker, checkpoint)?;
        // Links can address `MAX_SENDERS` senders: beyond, the finest levels receive and do not send.
        while points.count_on(settings.operator.sender_levels) > MAX_SENDERS
            && settings.operator.sender_levels > 1
        {
            settings.operator.sender_levels -= 1;
        }
        // Graded levels have more points; later bounces cost the square of the number of points on their levels.
        while far > 0
            && settings.operator.later_levels > far + 1
            && points.count_on(settings.operator.later_levels) > MOST_LATER
        {
            settings.operator.later_levels -= 1;
        }
        settings = settings.normalised();
        report.sender_levels = settings.operator.sender_levels as u64;
        let task = tracker.task(Stage::Basis, None);
        let relations = relate(&points, settings.direct_levels)?;
        if self.team.rank() == 0 {
            openness(self.surfaces, &mut points, &Uncounted(&task))?;
        }
        task.step(points.points.len() as u64)?;
        drop(task);
        let task = tracker.task(Stage::Colours, None);
        settings.operator.reflected = reflected_share(self.surfaces, &points, far, settings.operator.seed);
        let tints = tint::tints(self.surfaces, &points, settings.operator.seed, &task)?;
        agree(self.scene, &asked, &points, &tints, self.team, &task)?;
        let told = &settings.operator;
        drop(task);
        let task = tracker.task(Stage::Tiles, None);
        let senders = Senders::new(self.surfaces, &points, told, &tints, &task)?;
        drop(task);
        let mut refiner = Refiner::new(self.surfaces, &points, &relations, told, &senders, tints);
        let levels = points.levels.len();
        for level in 0..levels {
            tracker.expect(|estimate| estimate.expect_rays(level, refiner.rays_ahead() as f64));
            let traffic = refiner.level(&tracker.task(Stage::Links, Some(level)), journal, self.team)?;
            report.add_traffic(Stage::Links, Some(level), traffic);
            if level + 1 == told.later_levels.min(levels) && told.bounces != Some(1) {
                refiner.relate_coarse(&tracker.task(Stage::Among, None))?;
                let operator = refiner.operator_mut();
                let entries = operator.coarse_count();
                let columns = column_count(operator, told);
                tracker.expect(|estimate| estimate.expect_bounces(columns as f64, entries as f64));
                let task = tracker.task(Stage::Bounces, None);
                let traffic = add_later_bounces(operator, told, &task, journal, self.team)?;
                report.add_traffic(Stage::Bounces, None, traffic);
            }
            let has_bounces = level + 1 >= told.later_levels;
            if has_bounces && level + 1 < levels && self.observer.wants_previews() {
                let file = self.file(&settings, &points, &relations, refiner.operator())?;
                self.observer.preview(Preview { file, levels: level + 1 });
            }
        }
        let operator = refiner.finish();
        if self.team.rank() != 0 {
            return Ok(None);
        }
        let task = tracker.task(Stage::Assemble, None);
        report.describe(&points, &operator, &settings);
        let file = self.file(&settings, &points, &relations, &operator)?;
        report.is_unlit = !self.is_lit(&file);
        task.step(0)?;
        drop(task);
        report.seconds = tracker.seconds();
        Ok(Some((file, report)))
    }

    /// All points with their cuts and samples.
    fn points(
        &self,
        mut placer: Placer<TriangleSurfaces>,
        settings: &BakeSettings,
        tracker: &Tracker,
        checkpoint: Option<&Checkpoint>,
    ) -> Result<Points, BakeError> {
        for level in 0..placer.levels() {
            let task = tracker.task(Stage::Points, Some(level));
            if let Some((mark, points)) = checkpoint.and_then(|checkpoint| checkpoint.take_placed(level)) {
                task.skip(points.len() as u64)?;
                placer.take_over(points, mark);
            } else {
                placer.level(&task)?;
                let points = placer.points();
                if let (Some(checkpoint), Some(level)) = (checkpoint, points.levels.last()) {
                    checkpoint.keep_placed(&placer.mark(), &points.points[level.range()]);
                }
            }
            drop(task);
            let counts: Vec<usize> = placer.points().levels.iter().map(|level| level.count).collect();
            tracker.expect(|estimate| estimate.found_points(settings, &counts));
        }
        let mut points = placer.into_points();
        let task = tracker.task(Stage::Walls, None);
        if let Some(checkpoint) = checkpoint {
            let (cuts, samples) = checkpoint.take_shaped();
            if samples.len() <= points.points.len() {
                (points.cuts, points.samples) = (cuts, samples);
            }
            task.skip(2 * points.samples.len() as u64)?;
        }
        while points.samples.len() < points.points.len() {
            let first = points.samples.len();
            let end = points.points.len().min(first + SHAPED);
            cut(self.surfaces, &mut points, end, &task)?;
            footprint(self.surfaces, &mut points, end, &task)?;
            if let Some(checkpoint) = checkpoint {
                checkpoint.keep_shaped(first, &points.cuts[first..], &points.samples[first..]);
            }
        }
        drop(task);
        Ok(points)
    }

    /// Returns whether a light reaches any point of the coarsest levels.
    fn is_lit(&self, file: &BakedScene) -> bool {
        let lights: Vec<_> = file.meta.lights.iter().map(|light| light.source(file.meta.origin)).collect();
        let coarse: u32 = file.meta.levels.iter().take(LIT_LEVELS).map(|level| level.count).sum();
        let mut points = file.points.iter().take(coarse as usize);
        points.any(|point| at_footprint(self.surfaces, &lights, point) != Vec3::ZERO)
    }

    /// The file's contents.
    fn file(
        &self,
        settings: &BakeSettings,
        points: &Points,
        relations: &Relations,
        operator: &Operator,
    ) -> Result<BakedScene, BakeError> {
        if points.cuts.iter().map(Vec::len).sum::<usize>() > MAX_ALL_CUTS {
            return Err(BakeError::TooManyCuts);
        }
        Ok(assemble(self.scene, settings, self.staged.clone(), points, relations, operator))
    }
}
