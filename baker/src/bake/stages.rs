//! A bake's stages in order: points, hierarchy, transport, file.

use super::assemble::assemble;
use super::identity::digest_of_points;
use super::observer::{Observer, Preview};
use super::placed::{ClippedPoints, PlacedLevel};
use super::stand_in::Staged;
use super::tracker::Tracker;
use super::{BakeError, BakeReport, BakeSettings, BakeSolver, Purpose};
use crate::basis::{Relations, relate};
use crate::geometry::Surfaces;
use crate::job::Job;
use crate::job::reporter::Quiet;
use crate::job::stage::Stage;
use crate::job::watch::{Stopped, Uncounted, Watch};
use crate::light::direct::at_footprint;
use crate::sampling::cube_maps::{cube_maps, open_share};
use crate::sampling::emitter::ParticleEmitter;
use crate::sampling::{GroupPlacement, PlaceSettings, Placer, Points, cut, footprint, openness, place};
use crate::scene::{Scene, emissive_groups};
use crate::transport::environment::keep_for_environment;
use crate::transport::gloss::glossy_transfer;
use crate::transport::sources::{SourceGather, SourceLinks};
use crate::transport::{Operator, Problem, Solver, Unlinked};
use glam::Vec3;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::Light;
use rebounce_shared::link::MAX_SENDERS;
use rebounce_shared::rbn::bulk::MAX_ALL_CUTS;

/// Number of points per checkpoint record of cuts and samples.
const CLIPPED: usize = 1 << 15;
/// Number of coarse levels used to test whether any point is lit.
const LIT_LEVELS: usize = 4;
/// Maximum number of points for later bounces in a scene with graded point density; the number of levels for later
/// bounces is lowered to meet the maximum, as far as possible.
const MOST_LATER: usize = 6_000;
/// Functions on the finest level of a sketch, levels, and rays per receiver.
const SKETCH: (usize, usize, u32) = (3_000, 3, 512);

/// Inputs of all stages.
pub(super) struct Recipe<'a, S: Surfaces + ?Sized> {
    pub scene: &'a Scene,
    pub surfaces: &'a S,
    pub emitter: &'a ParticleEmitter,
    pub staged: &'a Staged,
    /// Mean share of light that goes through each material.
    pub transmittance: &'a [f32],
    pub observer: &'a dyn Observer,
    pub job: Job<'a>,
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

impl<S: Surfaces + ?Sized> Recipe<'_, S> {
    /// Bakes coarsely and hands the result to the observer as a preview.
    pub(super) async fn sketch(
        &self,
        solver: &impl Solver<S, Solution = Operator>,
        mut settings: BakeSettings,
        watch: &dyn Watch,
    ) -> Result<(), BakeError> {
        let quiet = &Uncounted(watch);
        settings.place.groups = GroupPlacement::of_groups(&self.scene.groups);
        let mut points = place(self.surfaces, self.emitter, &settings.place, quiet)?;
        settings = settings.deepened(points.levels.len());
        let end = points.points.len();
        cut(self.surfaces, &mut points, end, quiet)?;
        footprint(self.surfaces, &mut points, end, quiet)?;
        let relations = relate(&points, settings.direct_levels)?;
        let problem = Problem {
            surfaces: self.surfaces,
            points: &points,
            relations: &relations,
            settings: &settings.operator,
        };
        let is_first = self.job.communicator.rank() == 0;
        let mut job = Job { reporter: &Quiet(watch), ..Job::default() };
        if !self.job.communicator.is_blocking() {
            // All workers of a page know what it wants; other processes do not know what process 0's observer wants.
            job.communicator = self.job.communicator;
        }
        if self.observer.wants_points() {
            let unlinked = Unlinked.solve(&problem, &job, &mut |_, _| Ok(())).await?;
            if is_first {
                let settings = BakeSettings { solver: BakeSolver::Radiosity, ..settings.clone() };
                let file = self.file(&settings, &points, &relations, &unlinked, SourceLinks::default());
                self.observer.preview(Preview { file, levels: 0 });
            }
        }
        let operator = solver.solve(&problem, &job, &mut |_, _| Ok(())).await?;
        let groups = emissive_groups(self.scene);
        let gather = SourceGather::new(self.surfaces, &points, &relations, &settings.sources, groups);
        let links = gather.links(&job, quiet).await?;
        if is_first {
            let file = self.file(&settings, &points, &relations, &operator, links);
            self.observer.preview(Preview { file, levels: 0 });
        }
        Ok(())
    }

    /// Bakes; returns the result on process 0, `None` on the others.
    pub(super) async fn run(
        &self,
        solver: &impl Solver<S, Solution = Operator>,
        settings: BakeSettings,
        tracker: &Tracker<'_>,
        mut report: BakeReport,
    ) -> Result<Option<(BakedScene, BakeReport)>, BakeError> {
        let is_first = self.job.communicator.rank() == 0;
        report.processes = self.job.communicator.size() as u64;
        let (mut points, settings) = self.points(&settings, tracker, true)?;
        report.sender_levels = settings.operator.sender_levels as u64;
        let task = tracker.task(Stage::Hierarchy, None);
        let relations = relate(&points, settings.direct_levels)?;
        if is_first {
            openness(self.surfaces, &mut points, &Uncounted(&task))?;
        }
        task.step(points.points.len() as u64)?;
        let points = points;
        self.job.agree(&digest_of_points(self.scene, &settings, &points), &task).await?;
        drop(task);
        let problem = Problem {
            surfaces: self.surfaces,
            points: &points,
            relations: &relations,
            settings: &settings.operator,
        };
        let groups = emissive_groups(self.scene);
        let gather = SourceGather::new(self.surfaces, &points, &relations, &settings.sources, groups);
        tracker.expect(|estimate| estimate.expect_sources(points.points.len(), gather.rays()));
        let links = async || gather.links(&self.job, &tracker.task(Stage::Sources, None)).await;
        let shows = is_first && self.observer.wants_previews();
        // Previews have the light of the sky and of emissive surfaces, too; only process 0 knows whether there are any.
        let early = if shows || self.job.communicator.size() > 1 { Some(links().await?) } else { None };
        let mut preview = |operator: &Operator, levels| {
            if let Some(sources) = early.as_ref().filter(|_| shows) {
                let file = self.file(&settings, &points, &relations, operator, sources.clone());
                self.observer.preview(Preview { file, levels });
            }
            Ok::<(), Stopped>(())
        };
        let operator = solver.solve(&problem, &self.job, &mut preview).await?;
        if !is_first {
            return Ok(None);
        }
        let sources = match early {
            Some(sources) => sources,
            None => links().await?,
        };
        report.describe_sources(&sources);
        if settings.purpose == Purpose::Environment && !sources.sources.has_sky {
            return Err(BakeError::NoSky);
        }
        let task = tracker.task(Stage::Assemble, None);
        tracker.traffic().into_iter().for_each(|sent| report.add_traffic(sent));
        report.describe(&points, &operator, &settings);
        let mut file = self.file(&settings, &points, &relations, &operator, sources);
        report.is_unlit = !self.is_lit(&file);
        task.step(0)?;
        drop(task);
        if let Some(gloss) = settings.gloss.as_ref().filter(|_| settings.solver == BakeSolver::Operator) {
            let task = tracker.task(Stage::Gloss, None);
            let found = glossy_transfer(self.surfaces, &points, &file, gloss, &task)?;
            (file.gloss, report.gloss) = found;
            // Maps show where things stand.
            let stands = file.groups.nodes.is_empty();
            if cfg!(feature = "gloss") && stands && !file.gloss.links.is_empty() {
                let maps = cube_maps(self.surfaces, &file, &gloss.cube_maps);
                if open_share(&maps) <= gloss.cube_maps.most_open {
                    file.cube_maps = maps;
                }
                report.gloss.cube_maps = file.cube_maps.layout.places.len() as u64;
                report.gloss.cube_map_texels = file.cube_maps.texels.len() as u64;
            }
        }
        if settings.purpose == Purpose::Environment {
            let task = tracker.task(Stage::Gloss, None);
            report.transfer = Some(keep_for_environment(&mut file, &settings.transfer));
            task.step(0)?;
        }
        report.seconds = tracker.seconds();
        Ok(Some((file, report)))
    }

    /// Places all points with their cuts, and with the samples of direct light where it `is_sampled`; returns the points,
    /// and the settings adapted to their levels.
    pub(super) fn points(
        &self,
        settings: &BakeSettings,
        tracker: &Tracker<'_>,
        is_sampled: bool,
    ) -> Result<(Points, BakeSettings), BakeError> {
        let groups = GroupPlacement::of_groups(&self.scene.groups);
        let place = PlaceSettings { groups, ..settings.place.clone() };
        let mut placer = Placer::new(self.surfaces, self.emitter, &place)?;
        let mut adapted = settings.clone();
        let far = placer.levels().saturating_sub(settings.place.levels);
        if far > 0 {
            adapted = adapted.deepened(placer.levels());
            tracker.expect(|estimate| estimate.found_levels(&adapted));
        }
        for level in 0..placer.levels() {
            self.place_level(&mut placer, level, tracker)?;
            let counts: Vec<usize> = placer.points().levels.iter().map(|level| level.count).collect();
            tracker.expect(|estimate| estimate.found_points(&adapted, &counts));
        }
        let mut points = placer.into_points();
        let task = tracker.task(Stage::ClipPlanes, None);
        match is_sampled {
            true => self.clip(&mut points, &task)?,
            false => {
                let end = points.points.len();
                cut(self.surfaces, &mut points, end, &task)?;
            }
        }
        drop(task);
        if points.cuts.iter().map(Vec::len).sum::<usize>() > MAX_ALL_CUTS {
            return Err(BakeError::TooManyCuts);
        }
        let operator = &mut adapted.operator;
        // Links can address `MAX_SENDERS` senders: beyond, the finest levels receive and do not send.
        while points.count_on(operator.sender_levels) > MAX_SENDERS && operator.sender_levels > 1 {
            operator.sender_levels -= 1;
        }
        // Graded levels have more points; later bounces cost the square of the number of points on their levels.
        while far > 0
            && operator.later_levels > far + 1
            && points.count_on(operator.later_levels) > MOST_LATER
        {
            operator.later_levels -= 1;
        }
        Ok((points, adapted.normalised()))
    }

    /// Places the points of the next level, or takes them from the partial results.
    fn place_level(&self, placer: &mut Placer<S>, level: usize, tracker: &Tracker) -> Result<(), BakeError> {
        let task = tracker.task(Stage::Points, Some(level));
        if let Some(PlacedLevel { mark, points }) = PlacedLevel::take(self.job.partial_results, level) {
            task.skip(points.len() as u64)?;
            placer.take_over(points, mark);
            return Ok(());
        }
        placer.level(&task)?;
        let points = placer.points();
        if let Some(placed) = points.levels.last() {
            let points = points.points[placed.range()].to_vec();
            PlacedLevel { mark: placer.mark(), points }.keep(self.job.partial_results, level);
        }
        Ok(())
    }

    /// Finds the cuts and samples of all points, or takes them from the partial results.
    fn clip(&self, points: &mut Points, watch: &dyn Watch) -> Result<(), BakeError> {
        while points.samples.len() < points.points.len() {
            let first = points.samples.len();
            let end = points.points.len().min(first + CLIPPED);
            let stored = ClippedPoints::take(self.job.partial_results, first);
            if let Some(stored) = stored.filter(|stored| stored.samples.len() == end - first) {
                points.cuts.extend(stored.cuts);
                points.samples.extend(stored.samples);
                watch.skip(2 * (end - first) as u64)?;
                continue;
            }
            cut(self.surfaces, points, end, watch)?;
            footprint(self.surfaces, points, end, watch)?;
            let clipped = ClippedPoints {
                cuts: points.cuts[first..].to_vec(),
                samples: points.samples[first..].to_vec(),
            };
            clipped.keep(self.job.partial_results, first);
        }
        Ok(())
    }

    /// Returns whether a light reaches any point of the coarsest levels.
    fn is_lit(&self, file: &BakedScene) -> bool {
        let is_of_sources = |light: &Light| match light {
            Light::Environment { .. } => file.sources.has_sky,
            Light::Emissive { group, .. } => (*group as usize) < file.sources.groups.len(),
            _ => false,
        };
        if file.meta.lights.iter().any(is_of_sources) {
            return true;
        }
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
        sources: SourceLinks,
    ) -> BakedScene {
        let mut file =
            assemble(self.scene, settings, self.staged.clone(), points, (relations, operator, sources));
        file.groups.transmittance = self.transmittance.to_vec();
        file
    }
}
