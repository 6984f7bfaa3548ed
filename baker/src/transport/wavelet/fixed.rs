//! A [fixed solution](FixedSolution) by wavelet radiosity: evaluated at the points of a file.

use super::scene_patches::ScenePatches;
use super::{Figures, WaveletError, WaveletSettings, WaveletSolution, solve};
use crate::geometry::Surfaces;
use crate::job::Job;
use crate::job::communicator::CommunicatorError;
use crate::job::stage::Stage;
use crate::job::watch::{Stopped, Watch};
use crate::light::direct::at_point;
use crate::random::Stream;
use crate::transport::Problem;
use crate::transport::radiosity::{FixedSolution, GroupSource, linked_irradiance, source_links};
use crate::transport::sources::SourceSettings;
use glam::{DVec2, Vec3};
use rayon::prelude::*;
use rebounce_shared::environment::bins::{BINS, bin_of};
use rebounce_shared::rbn::sources::EmissiveGroup;

/// Directions to the sky from a control point.
const SKY_DIRECTIONS: u64 = 64;

/// Wavelet radiosity of a scene's lights, one after the other (Alonso et al. 2001).
pub struct WaveletRadiosity<'a> {
    /// Groups of light, at unit strength.
    pub groups: Vec<GroupSource>,
    /// The patches of the scene.
    pub patches: &'a ScenePatches,
    /// Accuracy.
    pub settings: WaveletSettings,
    /// How light of the sky and of emissive surfaces reaches the points of the file.
    pub sources: SourceSettings,
    /// Groups of emissive surfaces, in the order of the emission of [`GroupSource::lighting`].
    pub emissive_groups: Vec<EmissiveGroup>,
}

/// Wavelet radiosity of each group of light.
#[derive(Debug, Default)]
pub struct WaveletGroups {
    /// By group.
    pub solutions: Vec<WaveletSolution>,
}

impl WaveletGroups {
    /// What all of them took.
    pub fn figures(&self) -> Figures {
        self.solutions.iter().fold(Figures::default(), |sum, solution| {
            let one = &solution.figures;
            Figures {
                leaf_cells: sum.leaf_cells + one.leaf_cells,
                cells: sum.cells + one.cells,
                coefficients: sum.coefficients + one.coefficients,
                bytes: sum.bytes + one.bytes,
                shooting_patches: sum.shooting_patches.max(one.shooting_patches),
                shots: sum.shots + one.shots,
                rays: sum.rays + one.rays,
                convergence: one.convergence.clone(),
            }
        })
    }
}

impl WaveletRadiosity<'_> {
    /// Solves for each group of light.
    ///
    /// # Errors
    /// [`WaveletError`].
    pub fn groups<S: Surfaces>(
        &self,
        surfaces: &S,
        watch: &dyn Watch,
    ) -> Result<WaveletGroups, WaveletError> {
        let mut out = WaveletGroups::default();
        for GroupSource { lighting, .. } in &self.groups {
            let patches = self.patches.with_emission(&self.emissive_groups, &lighting.emission);
            let direct = |position: Vec3, normal: Vec3| {
                let lamps = at_point(surfaces, &lighting.lamps, position, normal);
                let sky = lighting.sky.as_deref();
                lamps + sky.map_or(Vec3::ZERO, |sky| from_sky(surfaces, sky, position, normal))
            };
            let progress = |_| watch.step(0);
            out.solutions.push(solve(&patches, surfaces, direct, &self.settings, progress)?);
        }
        Ok(out)
    }

    /// Solves, and evaluates the solutions at the points of a problem.
    ///
    /// # Errors
    /// [`WaveletError`], as [`CommunicatorError`] if the job is stopped.
    pub async fn solve<S: Surfaces>(
        &self,
        problem: &Problem<'_, S>,
        job: &Job<'_>,
    ) -> Result<(FixedSolution, WaveletGroups), WaveletRadiosityError> {
        let &Problem { surfaces, points, relations, .. } = problem;
        let links = source_links(&self.groups, &self.sources, &self.emissive_groups, problem, job).await?;
        let count = points.points.len();
        let linked = linked_irradiance(relations, &self.groups, &links, count);
        let watch = job.reporter.begin(Stage::Transport, None);
        let solved = self.groups(surfaces, &*watch)?;
        let mut out = FixedSolution {
            rays: solved.figures().rays,
            ..FixedSolution::new(count, &self.groups, linked, links.rays)
        };
        let at = |i: usize| {
            let point = &points.points[i];
            let epsilon = surfaces.epsilon_at(point.position);
            self.patches.locate(point.position, point.normal, epsilon)
        };
        let located: Vec<_> = (0..count).into_par_iter().map(at).collect();
        for (i, place) in located.iter().enumerate() {
            let Some(place) = place else {
                out.bounced.predict(relations, i);
                continue;
            };
            out.is_gathered[i] = true;
            for (value, solution) in out.bounced.at_mut(i).iter_mut().zip(&solved.solutions) {
                let st = place.st.clamp(DVec2::ZERO, DVec2::ONE);
                *value = solution.irradiance(place.patch, st).max(Vec3::ZERO);
            }
        }
        out.measure(points);
        Ok((out, solved))
    }
}

/// Why there is no solution.
#[derive(Debug, thiserror::Error)]
pub enum WaveletRadiosityError {
    /// Of the patches.
    #[error(transparent)]
    Wavelet(#[from] WaveletError),
    /// The job was stopped.
    #[error(transparent)]
    Job(#[from] CommunicatorError),
    /// The job was stopped.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// Irradiance from the sky, by rays in fixed directions.
fn from_sky<S: Surfaces>(surfaces: &S, sky: &[Vec3; BINS], position: Vec3, normal: Vec3) -> Vec3 {
    let (low, high) = surfaces.bounds();
    let far = 2.0 * (high - low).length();
    let origin = position + normal * surfaces.epsilon_at(position);
    let one = |i| {
        let direction = Stream::new(9, i).cosine_hemisphere(normal);
        let radiance = sky[bin_of(direction)];
        if radiance == Vec3::ZERO {
            radiance
        } else {
            radiance * surfaces.transmittance(origin, origin + far * direction)
        }
    };
    std::f32::consts::PI / SKY_DIRECTIONS as f32 * (0..SKY_DIRECTIONS).map(one).sum::<Vec3>()
}
