//! A [fixed solution](FixedSolution) by radiance and antiradiance: solved at patches, evaluated at the points of a file.

use super::direct::{add_linked, by_bin, of_lamps};
use super::figures::{AntiradianceWork, Follower};
use super::near::{AreaPoint, Near};
use super::pool::Pool;
use super::scene_patches::patches_of;
use crate::geometry::Surfaces;
use crate::job::Job;
use crate::job::clock;
use crate::job::communicator::CommunicatorError;
use crate::job::stage::Stage;
use crate::job::watch::{Stopped, Watch};
use crate::sampling::Points;
use crate::scene::Scene;
use crate::transport::Problem;
use crate::transport::radiosity::{FixedSolution, GroupSource, linked_irradiance, source_links};
use crate::transport::sources::SourceSettings;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::antiradiance::{AntiradianceSolver, DirectLight, Iteration, SolverSettings};
use rebounce_shared::rbn::sources::EmissiveGroup;

/// Share of the elements that are patches; the rest are clusters.
const PATCHES: f64 = 0.7;
/// How far a patch has a weight at points, in sides of a square of a patch's mean area.
const REACH: f32 = 2.0;

/// Accuracy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AntiradianceSettings {
    /// About how many patches and clusters.
    pub elements: usize,
    /// Whether metals reflect by a lobe; they are matt without.
    pub gloss: bool,
    /// Bins, links, iteration.
    pub solver: SolverSettings,
}

impl Default for AntiradianceSettings {
    fn default() -> Self {
        Self { elements: 18_000, gloss: false, solver: SolverSettings::default() }
    }
}

impl AntiradianceSettings {
    /// About how many of the elements are patches.
    pub fn patches(&self) -> usize {
        ((self.elements as f64 * PATCHES) as usize).max(1)
    }
}

/// Why there is no solution.
#[derive(Debug, thiserror::Error)]
pub enum AntiradianceError {
    /// The scene has no triangles with an area.
    #[error("the scene has no surface for patches of antiradiance")]
    Empty,
    /// The job was stopped.
    #[error(transparent)]
    Job(#[from] CommunicatorError),
    /// The job was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Bounced light of a scene's lights, one after the other (Dachsbacher et al. 2007).
pub struct Antiradiance<'a> {
    /// Groups of light, at unit strength.
    pub groups: Vec<GroupSource>,
    /// Where the patches come from.
    pub scene: &'a Scene,
    /// Accuracy.
    pub settings: AntiradianceSettings,
    /// How light of the sky and of emissive surfaces reaches the points of the file.
    pub sources: SourceSettings,
    /// Groups of emissive surfaces, in the order of the emission of [`GroupSource::lighting`].
    pub emissive_groups: Vec<EmissiveGroup>,
}

impl Antiradiance<'_> {
    /// Solves, and evaluates the solution at the points of a problem.
    ///
    /// # Errors
    /// [`AntiradianceError`].
    pub async fn solve<S: Surfaces>(
        &self,
        problem: &Problem<'_, S>,
        job: &Job<'_>,
    ) -> Result<(FixedSolution, AntiradianceWork), AntiradianceError> {
        let &Problem { surfaces, points, relations, .. } = problem;
        let links = source_links(&self.groups, &self.sources, &self.emissive_groups, problem, job).await?;
        let count = points.points.len();
        let linked = linked_irradiance(relations, &self.groups, &links, count);
        let watch = job.reporter.begin(Stage::Transport, None);
        let patches = patches_of(self.scene, self.settings.patches(), self.settings.gloss);
        if patches.is_empty() {
            return Err(AntiradianceError::Empty);
        }
        let begin = clock::wall();
        let solver = AntiradianceSolver::new(&patches, &self.settings.solver, &Pool);
        let mut work =
            work_of(&solver, self.settings.solver.iteration, (clock::wall() - begin).as_secs_f64());
        let finest = Finest::new(points);
        let near_points = Near::new(&finest.places, finest.spacing);
        let mut out =
            FixedSolution { bounces: 1, ..FixedSolution::new(count, &self.groups, linked, links.rays) };
        let of_patches: Vec<AreaPoint> = patches.iter().map(AreaPoint::from).collect();
        let whole: f32 = of_patches.iter().map(|place| place.area).sum();
        let near_patches = Near::new(&of_patches, REACH * (whole / patches.len() as f32).sqrt());
        let mut is_near = vec![true; count];
        for (number, group) in self.groups.iter().enumerate() {
            let mut direct = of_lamps(surfaces, &patches, group, &*watch)?;
            if group.has_links {
                let values: Vec<Vec3> = out.linked.group(number).skip(finest.first).collect();
                add_linked(&patches, &values, &near_points, &mut direct);
            }
            let direct = by_bin(surfaces, &solver, &group.lighting.lamps, direct);
            let found = solve_one(&solver, &self.settings.solver, &direct, &*watch, &mut work)?;
            let at = |i: usize| {
                let point = &points.points[i];
                near_patches.mean(point.position, point.normal, &found)
            };
            let values: Vec<Option<Vec3>> = (0..count).into_par_iter().map(at).collect();
            for (i, value) in values.into_iter().enumerate() {
                is_near[i] &= value.is_some();
                out.bounced.at_mut(i)[number] = value.unwrap_or(Vec3::ZERO).max(Vec3::ZERO);
            }
        }
        for (i, is_near) in is_near.into_iter().enumerate() {
            out.is_gathered[i] = is_near;
            if !is_near {
                out.bounced.predict(relations, i);
            }
        }
        out.measure(points);
        out.bounces = work.iterations;
        Ok((out, work))
    }
}

/// Solves for the direct irradiance of one group, and adds what it took.
fn solve_one(
    solver: &AntiradianceSolver<'_>,
    settings: &SolverSettings,
    direct: &DirectLight,
    watch: &dyn Watch,
    work: &mut AntiradianceWork,
) -> Result<Vec<Vec3>, Stopped> {
    let mut follower = Follower::new(watch);
    let (found, figures) = solver.solve(direct, settings, &Pool, &mut follower);
    follower.stopped?;
    work.pass_seconds.iter_mut().zip(follower.seconds).for_each(|(sum, own)| *sum += own);
    work.iterations = figures.iterations;
    work.differences = follower.steps.iter().map(|step| solver.difference(step, &found)).collect();
    Ok(found)
}

fn work_of(solver: &AntiradianceSolver<'_>, iteration: Iteration, link_seconds: f64) -> AntiradianceWork {
    AntiradianceWork {
        bins: solver.bins.count(),
        patches: solver.patches.len(),
        elements: solver.hierarchy.elements.len(),
        links: solver.links,
        transfers: solver.transfers.transfers.len(),
        link_seconds,
        bytes: solver.bytes(iteration) as u64,
        ..AntiradianceWork::default()
    }
}

/// The points of the finest level.
struct Finest {
    places: Vec<AreaPoint>,
    first: usize,
    spacing: f32,
}

impl Finest {
    fn new(points: &Points) -> Self {
        let Some(level) = points.levels.last() else {
            return Self { places: Vec::new(), first: 0, spacing: 1.0 };
        };
        let own = points.points[level.range()].iter();
        let places = own
            .map(|point| AreaPoint { position: point.position, normal: point.normal, area: 1.0 })
            .collect();
        Self { places, first: level.first, spacing: level.support_radius }
    }
}
