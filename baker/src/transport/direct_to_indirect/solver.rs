//! Solver for the direct-to-indirect operator: the stages in order, with progress, checkpoint and processes.

use super::bounces::{Columns, LaterBounces, column_count, set_later};
use super::mean_albedo::reflected_share;
use super::messages::GatheredChunk;
#[cfg(feature = "pairwise")]
use super::pairwise::Pairwise;
use super::refine::{LevelGather, Refiner};
use super::senders::Senders;
use super::tint::PointColour;
use super::{Operator, OperatorSettings, Refinement, tint};
use crate::geometry::Surfaces;
use crate::job::Job;
use crate::job::communicator::CommunicatorError;
use crate::job::parts::{Parts, compute_parts};
use crate::job::reporter::Work;
use crate::job::stage::Stage;
use crate::job::watch::{Stopped, Watch};
use crate::random::mix;
use crate::transport::{Partial, Problem, Solver};
use rayon::prelude::*;
use sha2::{Digest, Sha256};

/// Precomputes the operator S from direct to indirect irradiance (Lehtinen et al. 2008).
#[derive(Clone, Copy, Debug, Default)]
pub struct DirectToIndirect;

impl<S: Surfaces + ?Sized> Solver<S> for DirectToIndirect {
    type Solution = Operator;

    async fn solve(
        &self,
        problem: &Problem<'_, S>,
        job: &Job<'_>,
        partial: &mut Partial<'_, Operator>,
    ) -> Result<Operator, CommunicatorError> {
        let &Problem { surfaces, points, relations, .. } = problem;
        let mut settings = problem.settings.clone();
        let watch = job.reporter.begin(Stage::Tints, None);
        settings.reflected = reflected_share(surfaces, points, settings.far_levels, settings.seed);
        let (tints, reflectance) = colours(problem, &*watch)?;
        job.agree(&Sha256::digest(bytemuck::cast_slice(&tints)), &*watch).await?;
        drop(watch);
        let watch = job.reporter.begin(Stage::HitCache, None);
        let senders = Senders::new(surfaces, points, &settings, &tints, &*watch)?;
        let pairwise = match settings.refinement {
            Refinement::Gather => None,
            #[cfg(feature = "pairwise")]
            Refinement::Pairwise => {
                Some(Pairwise::new(surfaces, points, relations, &settings, &tints, &*watch)?)
            }
        };
        drop(watch);
        let mut refiner = Refiner::new(surfaces, points, relations, &settings, &senders, tints);
        refiner.set_pairwise(pairwise.as_ref());
        let levels = points.levels.len();
        let coarse_levels = settings.later_levels.min(levels);
        for level in 0..levels {
            links(&mut refiner, level, job).await?;
            if level + 1 == coarse_levels && settings.bounces != Some(1) {
                later_bounces(&mut refiner, &settings, job).await?;
            }
            // Without later bounces a partial operator is too dark to look at.
            if level + 1 >= settings.later_levels && level + 1 < levels {
                partial(refiner.operator(), level + 1)?;
            }
        }
        Ok(Operator { reflectance, ..refiner.finish() })
    }
}

/// Computes tints and reflectances of all points. A unit of `watch` is a point.
pub(in crate::transport) fn colours<S: Surfaces + ?Sized>(
    problem: &Problem<S>,
    watch: &dyn Watch,
) -> Result<(Vec<u32>, Vec<u8>), Stopped> {
    let count = problem.points.points.len();
    let (mut tints, mut reflectance) = (Vec::with_capacity(count), Vec::with_capacity(count));
    for (l, level) in problem.points.levels.iter().enumerate() {
        let found = level.range().into_par_iter().map(|i| {
            watch.step(1)?;
            Ok(tint::colour(problem.surfaces, problem.points, l, i, problem.settings.seed))
        });
        let found = found.collect::<Result<Vec<PointColour>, Stopped>>()?;
        tints.extend(found.iter().map(|colour| colour.tint));
        reflectance.extend(found.iter().map(|colour| colour.reflectance));
    }
    Ok((tints, reflectance))
}

/// Gathers the links of the next level.
async fn links<S: Surfaces + ?Sized>(
    refiner: &mut Refiner<'_, S>,
    level: usize,
    job: &Job<'_>,
) -> Result<(), CommunicatorError> {
    job.reporter.expect(Work::Rays { level, rays: refiner.rays_ahead() });
    let watch = job.reporter.begin(Stage::Links, Some(level));
    let (found, traffic) = compute_parts(&refiner.next_level(), job, &*watch).await?;
    job.reporter.sent(Stage::Links, Some(level), traffic);
    // Missing rows are never read on this process.
    let rows = found.into_iter().map(|chunk| chunk.map_or_else(Vec::new, |chunk| chunk.0));
    refiner.finish_level(rows.collect());
    Ok(())
}

/// Computes the coarse transport matrix and the later bounces.
async fn later_bounces<S: Surfaces + ?Sized>(
    refiner: &mut Refiner<'_, S>,
    settings: &OperatorSettings,
    job: &Job<'_>,
) -> Result<(), CommunicatorError> {
    let watch = job.reporter.begin(Stage::CoarseMatrix, None);
    let matrix = refiner.coarse_matrix();
    let row = |scratch: &mut _, i| {
        let row = matrix.row(i, scratch);
        watch.step(1).map(|()| row)
    };
    let rows = (0..matrix.count()).into_par_iter().map_init(|| matrix.scratch(), row);
    let rows = rows.collect::<Result<Vec<_>, Stopped>>()?;
    drop(watch);
    refiner.set_coarse(rows);
    let operator = refiner.operator_mut();
    let (columns, entries) = (column_count(operator, settings), operator.coarse_count());
    job.reporter.expect(Work::Multibounce { columns, entries });
    let watch = job.reporter.begin(Stage::Multibounce, None);
    let tints = tint::unpack(&operator.tints[..operator.coarse.len()]);
    let Some(later) = LaterBounces::new(&operator.coarse, &tints, settings) else { return Ok(()) };
    let (found, traffic) = compute_parts(&later, job, &*watch).await?;
    job.reporter.sent(Stage::Multibounce, None, traffic);
    // Only process 0 has all parts; no other process reads the rows.
    if let Some(parts) = found.into_iter().collect() {
        set_later(operator, parts);
    }
    Ok(())
}

impl<S: Surfaces + ?Sized> Parts for LevelGather<'_, '_, S> {
    type Found = GatheredChunk;
    const KIND: u32 = 3;

    fn count(&self) -> usize {
        self.count()
    }

    fn key(&self, part: usize) -> u64 {
        self.receivers(part).start as u64
    }

    fn compute(&self, part: usize) -> GatheredChunk {
        GatheredChunk(self.gather(part))
    }

    fn fits(&self, part: usize, found: &GatheredChunk) -> bool {
        self.fits(part, &found.0)
    }

    fn units(&self, _part: usize, found: &GatheredChunk) -> u64 {
        found.0.iter().map(|gathered| gathered.cost.rays).sum()
    }

    fn is_shared(&self) -> bool {
        self.is_read()
    }

    /// In random order over the scene, so that progress predicts the remaining time.
    fn order(&self, part: usize) -> u64 {
        mix(self.key(part))
    }
}

impl Parts for LaterBounces<'_> {
    type Found = Columns;
    const KIND: u32 = 4;

    fn count(&self) -> usize {
        self.count()
    }

    fn key(&self, part: usize) -> u64 {
        part as u64
    }

    fn compute(&self, part: usize) -> Columns {
        self.columns(part)
    }

    fn fits(&self, part: usize, found: &Columns) -> bool {
        self.fits(part, found)
    }

    fn units(&self, part: usize, _found: &Columns) -> u64 {
        self.senders(part).len() as u64
    }
}
