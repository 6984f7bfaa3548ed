//! A fixed solution: bounced light for lights that stay in place, in a file without links.

use super::assemble::assemble;
use super::baker::Built;
use super::solve_report::{AntiradianceReport, SolveReport, WaveletReport};
use super::stages::Recipe;
use super::tracker::Tracker;
use super::{BakeError, BakeReport, BakeSettings, Baker, Stage};
use crate::basis::relate;
use crate::geometry::Surfaces;
use crate::job::communicator::{CommunicatorError, run_blocking};
use crate::job::watch::{Uncounted, Watch};
use crate::sampling::openness;
use crate::scene::{Scene, emissive_groups};
#[cfg(feature = "antiradiance")]
use crate::transport::antiradiance::{Antiradiance, AntiradianceSettings};
use crate::transport::radiosity::{FixedSolution, GroupSource, ProgressiveRadiosity, RadiositySettings};
use crate::transport::sources::SourceLinks;
#[cfg(feature = "exact-faces")]
use crate::transport::wavelet::lightmap::{LightmapSource, add_lightmap};
#[cfg(feature = "exact-faces")]
use crate::transport::wavelet::{ScenePatches, WaveletGroups, WaveletRadiosity, WaveletSettings};
use crate::transport::{Operator, Problem, Solver};
use glam::Vec3;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::environment::PackedEnvironment;
use rebounce_shared::light::LightKind;
use rebounce_shared::light_group::at_unit_strength;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::rbn::light_groups::{LightGroup, LightGroups};
use rebounce_shared::rbn::sources::Sources;

/// Which solver makes a fixed solution.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum FixedSolver {
    /// Hierarchical progressive radiosity at the points (Lehtinen et al. 2007).
    #[default]
    Radiosity,
    /// Wavelet radiosity on virtual meshes (Alonso et al. 2001), evaluated at the points.
    #[cfg(feature = "exact-faces")]
    Wavelet(WaveletSettings),
    /// Radiance and antiradiance at patches (Dachsbacher et al. 2007), evaluated at the points.
    #[cfg(feature = "antiradiance")]
    Antiradiance(AntiradianceSettings),
}

/// Settings of a fixed solution.
#[derive(Clone, Debug)]
pub struct SolveSettings {
    /// Where points are, and what else a bake shares: bounces, levels of later bounces, seed.
    pub bake: BakeSettings,
    /// Rays and thresholds of radiosity.
    pub radiosity: RadiositySettings,
    /// The solver.
    pub solver: FixedSolver,
}

/// Solves for the lights of a scene. The same scene and settings give the same result at any thread count.
///
/// # Errors
/// [`BakeError`].
pub fn solve(scene: &Scene, settings: &SolveSettings) -> Result<(BakedScene, SolveReport), BakeError> {
    let baker = Baker::new(&settings.bake);
    let solved = baker.prepared(
        scene,
        || Built::of_scene(scene),
        false,
        async |recipe, tracker, report| recipe.solve(settings, tracker, report).await,
    );
    run_blocking(solved).ok_or(CommunicatorError::WouldBlock)?
}

/// A solution at the points, and what made it.
struct Solved {
    solution: FixedSolution,
    by_wavelets: Option<ByWavelets>,
    by_antiradiance: Option<AntiradianceReport>,
}

/// Wavelet radiosity of the patches.
#[cfg(feature = "exact-faces")]
struct ByWavelets {
    patches: ScenePatches,
    solved: WaveletGroups,
    settings: WaveletSettings,
}

/// Without exact faces no solution is by wavelets.
#[cfg(not(feature = "exact-faces"))]
enum ByWavelets {}

impl<S: Surfaces> Recipe<'_, S> {
    /// Places points, solves, and assembles the file.
    async fn solve(
        &self,
        settings: &SolveSettings,
        tracker: &Tracker<'_>,
        report: BakeReport,
    ) -> Result<(BakedScene, SolveReport), BakeError> {
        let (mut points, bake) = self.points(&settings.bake.clone().normalised(), tracker, false)?;
        let task = tracker.task(Stage::Hierarchy, None);
        let relations = relate(&points, points.levels.len())?;
        openness(self.surfaces, &mut points, &Uncounted(&task))?;
        task.step(points.points.len() as u64)?;
        drop(task);
        let points = points;
        let problem = Problem {
            surfaces: self.surfaces,
            points: &points,
            relations: &relations,
            settings: &bake.operator,
        };
        let Solved { solution, by_wavelets, by_antiradiance } =
            self.solution(settings, &problem, &bake).await?;
        let task = tracker.task(Stage::Assemble, None);
        let operator = Operator {
            bounces: solution.bounces,
            rays: solution.rays + solution.source_rays,
            ..Operator::without_links(points.points.len())
        };
        let parts = (&relations, &operator, SourceLinks::default());
        let mut file = assemble(self.scene, &bake, self.staged.clone(), &points, parts);
        self.add_groups(&mut file, &solution);
        let wavelet = by_wavelets.map(|own| self.add_lightmap(&mut file, own));
        drop(task);
        let mut report = SolveReport::new(report, &settings.radiosity, &solution);
        report.describe(&points, self.staged.lights.len(), tracker.seconds());
        report.wavelet = wavelet;
        report.antiradiance = by_antiradiance;
        Ok((file, report))
    }

    /// Runs the solver.
    async fn solution(
        &self,
        settings: &SolveSettings,
        problem: &Problem<'_, S>,
        bake: &BakeSettings,
    ) -> Result<Solved, BakeError> {
        let (groups, sources) = (self.group_sources(), bake.sources.clone());
        let emissive_groups = emissive_groups(self.scene);
        match settings.solver {
            FixedSolver::Radiosity => {
                let settings = settings.radiosity.clone();
                let solver = ProgressiveRadiosity { groups, settings, sources, emissive_groups };
                let solution = solver.solve(problem, &self.job, &mut |_, _| Ok(())).await?;
                Ok(Solved { solution, by_wavelets: None, by_antiradiance: None })
            }
            #[cfg(feature = "exact-faces")]
            FixedSolver::Wavelet(settings) => {
                let patches =
                    ScenePatches::new(self.scene, self.surfaces.epsilon()).ok_or(BakeError::Empty)?;
                let solver =
                    WaveletRadiosity { groups, patches: &patches, settings, sources, emissive_groups };
                let (solution, solved) = solver.solve(problem, &self.job).await?;
                let by_wavelets = Some(ByWavelets { patches, solved, settings });
                Ok(Solved { solution, by_wavelets, by_antiradiance: None })
            }
            #[cfg(feature = "antiradiance")]
            FixedSolver::Antiradiance(settings) => {
                let scene = self.scene;
                let solver = Antiradiance { groups, scene, settings, sources, emissive_groups };
                let (solution, work) = solver.solve(problem, &self.job).await?;
                let report = AntiradianceReport::new(&settings, work);
                Ok(Solved { solution, by_wavelets: None, by_antiradiance: Some(report) })
            }
        }
    }

    /// Adds the lightmap of a solution by wavelets; returns its figures.
    #[cfg(feature = "exact-faces")]
    fn add_lightmap(&self, file: &mut BakedScene, own: ByWavelets) -> WaveletReport {
        let ByWavelets { patches, solved, settings } = own;
        let epsilon = self.surfaces.epsilon();
        let lightmap = add_lightmap(file, LightmapSource { patches: &patches, solved: &solved, epsilon });
        WaveletReport::new(&patches, &settings, &solved.figures(), lightmap)
    }

    #[cfg(not(feature = "exact-faces"))]
    fn add_lightmap(&self, _: &mut BakedScene, own: ByWavelets) -> WaveletReport {
        match own {}
    }

    /// The lights of the file at unit strength.
    fn group_sources(&self) -> Vec<GroupSource> {
        let groups = emissive_groups(self.scene).len();
        let environment = self.scene.environment.as_ref();
        let group = |light| {
            GroupSource::new(Lighting::new(
                &[at_unit_strength(light)],
                environment,
                self.scene.origin,
                groups,
            ))
        };
        self.staged.lights.iter().map(group).collect()
    }

    /// Adds the light groups of a solution, and the emissive groups and the environment that are shown.
    fn add_groups(&self, file: &mut BakedScene, solution: &FixedSolution) {
        let lights = &mut file.meta.lights;
        let has_sky = lights.iter().any(|light| light.kind() == LightKind::Environment);
        let environment = self.scene.environment.as_ref().filter(|_| has_sky);
        file.sources = Sources {
            groups: emissive_groups(self.scene),
            environment: environment
                .map_or_else(Vec::new, |picture| PackedEnvironment::new(picture).to_bytes()),
            ..Sources::default()
        };
        if file.sources != Sources::default() {
            file.source_links.offsets = vec![0; file.points.len() + 1];
        }
        // A lamp that moves would leave its bounced light behind.
        for animation in &mut file.meta.animations {
            animation.tracks.retain(|track| !track.property.is_signed());
        }
        file.meta.animations.retain(|animation| !animation.tracks.is_empty());
        let groups = solution.floors.iter().zip(&solution.has_direct);
        let mut all = LightGroups {
            groups: groups.map(|(&floor, &has_direct)| LightGroup { floor, has_direct }).collect(),
            values: Vec::new(),
        };
        let push = file.relations.push();
        for (group, floor) in solution.floors.iter().enumerate() {
            let column: Vec<Vec3> = solution.bounced.group(group).collect();
            all.push_column(&column, *floor, push, |i| solution.is_gathered[i]);
        }
        for (group, floor) in
            solution.floors.iter().enumerate().filter(|(group, _)| solution.has_direct[*group])
        {
            let column: Vec<Vec3> = solution.linked.group(group).collect();
            all.push_column(&column, *floor, push, |_| true);
        }
        file.light_groups = all;
    }
}
