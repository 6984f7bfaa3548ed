//! Solver for lights that stay in place: direct light, coarse levels with all bounces, then finer receivers by the oracle.
//!
//! The report gathers anew for each bounce. Here the rays of the coarse levels are cast once and kept as rows, as later
//! bounces are smooth, and each finer receiver is gathered for once, with the light of all bounces: one pass of rays in
//! place of one for each bounce.

use super::ancestors::Ancestors;
use super::bounces::coarse_bounces;
use super::direct::{GroupField, GroupSource, direct_irradiance};
use super::gather::{ChannelRow, FieldGather, GatherMemory, GatherTime};
use super::receiver_oracle::ReceiverOracle;
use super::sender_level::SenderLevels;
use super::settings::RadiositySettings;
use super::solution::{FixedSolution, GatherCount};
use super::source_links::source_links;
use crate::geometry::Surfaces;
use crate::job::Job;
use crate::job::communicator::CommunicatorError;
use crate::job::stage::Stage;
use crate::job::watch::{Stopped, Watch};
use crate::transport::direct_to_indirect::accumulator::SparseAccumulator;
use crate::transport::direct_to_indirect::directions::Directions;
use crate::transport::sources::SourceSettings;
use crate::transport::{Partial, Problem, Solver};
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::rbn::sources::EmissiveGroup;

/// Hierarchical progressive radiosity for given lights (Lehtinen et al. 2007, section 6.3).
#[derive(Clone, Debug)]
pub struct ProgressiveRadiosity {
    /// Groups of light, at unit strength.
    pub groups: Vec<GroupSource>,
    /// Rays and thresholds.
    pub settings: RadiositySettings,
    /// How light of the sky and of emissive surfaces is computed.
    pub sources: SourceSettings,
    /// Groups of emissive surfaces, in the order of the emission of [`GroupSource::lighting`].
    pub emissive_groups: Vec<EmissiveGroup>,
}

impl<S: Surfaces + ?Sized> Solver<S> for ProgressiveRadiosity {
    type Solution = FixedSolution;

    async fn solve(
        &self,
        problem: &Problem<'_, S>,
        job: &Job<'_>,
        partial: &mut Partial<'_, FixedSolution>,
    ) -> Result<FixedSolution, CommunicatorError> {
        let &Problem { surfaces, points, relations, settings } = problem;
        let links = source_links(&self.groups, &self.sources, &self.emissive_groups, problem, job).await?;
        let watch = job.reporter.begin(Stage::DirectLight, None);
        let direct = direct_irradiance(surfaces, points, relations, &self.groups, &links, &*watch)?;
        let senders = SenderLevels::new(points, self.settings.epsilon_omega);
        drop(watch);
        let time = GatherTime::default();
        let gather = FieldGather { surfaces, points, senders: &senders, seed: settings.seed, time: &time };
        let levels = points.levels.len();
        let coarse_levels = settings.later_levels.clamp(1, levels.max(1)).min(levels);
        let (count, groups) = (points.points.len(), self.groups.len());
        let mut out = FixedSolution {
            bounces: 1,
            ..FixedSolution::new(count, &self.groups, direct.linked, links.rays)
        };
        let mut rows: Vec<Option<ChannelRow>> = vec![None; points.count_on(coarse_levels)];
        let mut pass =
            Pass { problem, gather, settings: &self.settings, oracle: None, refined: vec![false; count] };
        let ancestors = Ancestors::new(relations, count, points.count_on(coarse_levels));
        // The first bounce on the coarse levels.
        for level in 0..coarse_levels {
            let watch = job.reporter.begin(Stage::Transport, Some(level));
            let wanted = pass.wanted(level);
            let found = pass.coarse(level, &wanted, &direct.sent, &ancestors, &*watch)?;
            for (i, (values, row)) in wanted.iter().zip(found) {
                out.bounced.at_mut(*i).copy_from_slice(&values);
                rows[*i] = Some(row);
            }
            pass.finish(level, &wanted, &mut out);
        }
        // All bounces on the coarse levels.
        let coarse = points.count_on(coarse_levels);
        let first = GroupField { groups, values: out.bounced.values[..coarse * groups].to_vec() };
        let bounced = coarse_bounces(first, &rows, relations, settings.bounces);
        drop(rows);
        out.bounces = bounced.bounces;
        out.bounced.values[..coarse * groups].copy_from_slice(&bounced.total.values);
        out.bounced.push_from(relations, coarse);
        let mut sent = GroupField::new(count, groups);
        sent.values[..coarse * groups].copy_from_slice(&bounced.sent.values);
        sent.push_from(relations, coarse);
        sent.add(&direct.sent);
        pass.choose(coarse_levels.saturating_sub(1), &out);
        // All bounces on the finer levels.
        for level in coarse_levels..levels {
            partial(&out, level)?;
            let watch = job.reporter.begin(Stage::Transport, Some(level));
            let wanted = pass.wanted(level);
            let found = pass.fine(level, &wanted, &sent, &*watch)?;
            for (i, values) in wanted.iter().zip(found.chunks_exact(groups.max(1))) {
                let predicted: Vec<Vec3> = out.bounced.predicted(relations, *i).collect();
                let pairs = values.iter().zip(predicted);
                let significant =
                    |(found, predicted): (&(Vec3, f32), Vec3)| self.significant(*found, predicted);
                let values: Vec<Vec3> = pairs.map(significant).collect();
                out.bounced.at_mut(*i).copy_from_slice(&values);
            }
            pass.finish(level, &wanted, &mut out);
        }
        out.floors = pass.floors(self.settings.epsilon_e);
        out.gather_seconds = time.seconds();
        Ok(out)
    }
}

impl ProgressiveRadiosity {
    /// Returns the part of an irradiance that stands out of its noise: the prediction plus the coefficient, shrunk by the
    /// share of noise in its square (Wiener's filter). `found` is the irradiance and the variance of its brightness.
    fn significant(&self, (irradiance, variance): (Vec3, f32), predicted: Vec3) -> Vec3 {
        let coefficient = irradiance - predicted;
        let square = coefficient.length_squared() / 3.0;
        let noise = self.settings.significance.powi(2) * variance;
        let share = if square > noise { 1.0 - noise / square } else { 0.0 };
        predicted + share * coefficient
    }
}

/// The pass over the levels, coarsest first.
struct Pass<'a, S: ?Sized> {
    problem: &'a Problem<'a, S>,
    gather: FieldGather<'a, S>,
    settings: &'a RadiositySettings,
    /// Known after the coarsest level.
    oracle: Option<ReceiverOracle>,
    /// Whether the children of a point are gathered for.
    refined: Vec<bool>,
}

impl<S: Surfaces + ?Sized> Pass<'_, S> {
    /// Receivers of a level that are gathered for, ascending: children of refined ones, and points without parents. Functions
    /// as large as a house reach through it, so that those of the far levels are all gathered for, and the next finer ones.
    fn wanted(&self, level: usize) -> Vec<usize> {
        let Problem { points, relations, settings, .. } = self.problem;
        let is_far = settings.far_levels > 0 && level <= settings.far_levels;
        let is_wanted = |i: &usize| {
            let parents = relations.push().row(*i);
            is_far || parents.is_empty() || parents.iter().any(|parent| self.refined[parent.point()])
        };
        points.levels[level].range().into_par_iter().filter(is_wanted).collect()
    }

    /// Gathers the first bounce, and the rows of later ones.
    fn coarse(
        &self,
        level: usize,
        wanted: &[usize],
        field: &GroupField,
        ancestors: &Ancestors,
        watch: &dyn Watch,
    ) -> Result<Vec<(Vec<Vec3>, ChannelRow)>, Stopped> {
        let directions = Directions::new(self.settings.rays_on(level));
        let count = ancestors.coarse();
        let memory = || (GatherMemory::default(), SparseAccumulator::<3>::new(count));
        let receiver = |(memory, row): &mut (GatherMemory, SparseAccumulator<3>), i: &usize| {
            watch.step(1)?;
            Ok(self.gather.field_and_row(*i, &directions, field, ancestors, (memory, row)))
        };
        wanted.par_iter().map_init(memory, receiver).collect()
    }

    /// Gathers all bounces.
    fn fine(
        &self,
        level: usize,
        wanted: &[usize],
        field: &GroupField,
        watch: &dyn Watch,
    ) -> Result<Vec<(Vec3, f32)>, Stopped> {
        let directions = Directions::new(self.settings.rays_on(level));
        let chunks = wanted.par_chunks(FieldGather::<S>::batch_size(&directions));
        let found = chunks.map_init(GatherMemory::default, |memory, some| {
            watch.step(some.len() as u64)?;
            Ok(self.gather.field(some, &directions, field, memory))
        });
        Ok(found.collect::<Result<Vec<_>, Stopped>>()?.concat())
    }

    /// Interpolates what was not gathered for, at this level and all finer ones, and chooses the receivers to refine.
    fn finish(&mut self, level: usize, wanted: &[usize], out: &mut FixedSolution) {
        let Problem { points, relations, .. } = self.problem;
        let range = points.levels[level].range();
        wanted.iter().for_each(|i| out.is_gathered[*i] = true);
        for i in range.clone().filter(|i| !out.is_gathered[*i]) {
            out.bounced.predict(relations, i);
        }
        out.bounced.push_from(relations, range.end);
        out.levels.push(GatherCount { points: range.len() as u64, gathered: wanted.len() as u64 });
        out.rays += wanted.len() as u64 * u64::from(self.settings.rays_on(level));
        self.choose(level, out);
    }

    /// Chooses the receivers of a level whose children are gathered for.
    fn choose(&mut self, level: usize, out: &FixedSolution) {
        let Problem { points, relations, .. } = self.problem;
        let Some(range) = points.levels.get(level).map(|level| level.range()) else { return };
        if level == 0 {
            let oracle = ReceiverOracle::new(self.settings.epsilon_e, &out.bounced, range.len());
            self.refined[range].copy_from_slice(&oracle.refined_on_coarsest(points, &out.bounced));
            self.oracle = Some(oracle);
        } else if let Some(oracle) = &self.oracle {
            let is_refined = |i: usize| out.is_gathered[i] && oracle.is_refined(relations, &out.bounced, i);
            let refined: Vec<bool> = range.clone().into_par_iter().map(is_refined).collect();
            self.refined[range].copy_from_slice(&refined);
        }
    }

    /// Negligible irradiance by group: a 500th of the mean bounced irradiance of the coarsest level.
    fn floors(&self, epsilon_e: f32) -> Vec<f32> {
        let thresholds = self.oracle.as_ref().map_or(&[][..], ReceiverOracle::thresholds);
        thresholds.iter().map(|threshold| (threshold / epsilon_e / 500.0).clamp(1e-12, 1e12)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_certain_is_kept_and_noise_is_left_out() {
        let solver = ProgressiveRadiosity {
            groups: Vec::new(),
            settings: RadiositySettings { significance: 1.0, ..RadiositySettings::default() },
            sources: SourceSettings::default(),
            emissive_groups: Vec::new(),
        };
        let (found, predicted) = (Vec3::new(1.5, 1.5, 1.5), Vec3::ONE);
        assert_eq!(solver.significant((found, 0.0), predicted), found);
        assert_eq!(solver.significant((found, 0.25), predicted), predicted);
        assert_eq!(solver.significant((found, 0.125), predicted), Vec3::splat(1.25));
    }
}
