//! Links from sources to points, level by level, coarsest first: what a receiver gets, less what its parents predict
//! (paper, Eq. 17 and Fig. 5).

use super::emission::Emission;
use super::emitter_tree::Assigned;
use super::group_seen::GroupSeen;
use super::level::SourceLevel;
use super::messages::Receiver;
use super::quantize::Quantizer;
use super::sky::{Openings, SkyBins, see_sky};
use super::{SourceSettings, describe_groups};
use crate::basis::Relations;
use crate::geometry::Surfaces;
use crate::job::Job;
use crate::job::communicator::CommunicatorError;
use crate::job::communicator::share::Traffic;
use crate::job::parts::compute_parts;
use crate::job::stage::Stage;
use crate::job::watch::Watch;
use crate::sampling::Points;
use crate::transport::operator::COARSER;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::environment::bins::BINS;
use rebounce_shared::interpolation::Entry;
use rebounce_shared::link::{MAX_STEPS, Sent, SourceLink};
use rebounce_shared::rbn::sources::{EmissiveGroup, Sources};
use std::f32::consts::PI;
use std::ops::Range;

/// Levels whose receivers are all gathered for.
const ALL: usize = 2;
/// Step of a link, as a share of ε on the finest level.
const STEP: f32 = 0.5;
/// Significance of a link from the sky over that from a group: sums over many bins have many chances to pass.
const MANY_BINS: f32 = 1.5;
/// Noise of a group's irradiance, over ε of the finest level, that calls for no more rays.
const CLEAR: f32 = 1.0;
/// Least mean irradiance of the coarsest levels from a sky of unit radiance for which the sky is a source: less comes
/// through cracks.
const LEAST_SKY: f32 = 3e-4;

/// Links from the sources of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SourceLinks {
    /// The sources.
    pub sources: Sources,
    /// Links of every point, sources ascending; empty without sources.
    pub links: Vec<Vec<SourceLink>>,
    /// Number of rays cast.
    pub rays: u64,
}

/// Working memory of a thread.
struct SourceScratch {
    assigned: Vec<Assigned>,
    seen: Vec<GroupSeen>,
    /// By group, the noise of the irradiance that calls for no more rays.
    tolerances: Vec<Vec3>,
}

/// Gathers the links from the sky and from emissive surfaces.
pub struct SourceGather<'a, S: ?Sized> {
    surfaces: &'a S,
    points: &'a Points,
    relations: &'a Relations,
    settings: &'a SourceSettings,
    emission: Option<Emission<'a>>,
    bins: SkyBins,
    sources: Sources,
    /// Mean irradiance of the coarsest level by source, for the sky that of all bins together.
    typical: Vec<f32>,
}

impl<'a, S: Surfaces + ?Sized> SourceGather<'a, S> {
    /// Finds the sources that reach the receivers of the coarsest level. `groups` have names and materials.
    pub fn new(
        surfaces: &'a S,
        points: &'a Points,
        relations: &'a Relations,
        settings: &'a SourceSettings,
        groups: Vec<EmissiveGroup>,
    ) -> Self {
        let mut sources = Sources { has_sky: settings.sky, groups, ..Sources::default() };
        let group_of = sources.group_of_materials();
        let emitters = surfaces.emitters().filter(|_| !sources.groups.is_empty());
        let mut most = Vec::new();
        match emitters {
            Some(emitters) => most = describe_groups(emitters, &group_of, &mut sources.groups),
            None => sources.groups.clear(),
        }
        let mut gather = Self {
            surfaces,
            points,
            relations,
            settings,
            emission: emitters.map(|emitters| Emission::new(emitters, &group_of, sources.groups.len())),
            bins: SkyBins::prepared(),
            sources,
            typical: Vec::new(),
        };
        if let Some(level) = points.levels.first() {
            gather.measure(level.range(), &most);
        }
        gather
    }

    /// Whether there is a source.
    pub fn is_any(&self) -> bool {
        self.sources.has_sky || self.emission.is_some()
    }

    /// Expected number of rays.
    pub fn rays(&self) -> u64 {
        let sky = if self.sources.has_sky { BINS as u64 / 2 } else { 0 };
        let rays_of = |emission: &Emission| {
            self.sources.groups.len() as u64 * u64::from(emission.rays_a_group(self.settings.emitter_rays[1]))
        };
        let emission = self.emission.as_ref().map_or(0, rays_of);
        self.points.points.len() as u64 * (sky + emission)
    }

    /// Computes the links, together with the other processes of a job; process 0 returns those of all points. A unit of
    /// `watch` is a point.
    ///
    /// # Errors
    /// [`CommunicatorError`].
    pub async fn links(&self, job: &Job<'_>, watch: &dyn Watch) -> Result<SourceLinks, CommunicatorError> {
        if !self.is_any() {
            return Ok(SourceLinks::default());
        }
        let job = Job { partial_results: &(), ..*job };
        let mut traffic = Traffic::default();
        let mut out = SourceLinks {
            sources: self.sources.clone(),
            links: vec![Vec::new(); self.points.points.len()],
            rays: 0,
        };
        // Receivers of the finished levels.
        let mut before: Vec<Receiver> = Vec::new();
        for (level, place) in self.points.levels.iter().enumerate() {
            let range = place.range();
            let gather = |receivers: Range<usize>| -> Vec<Receiver> {
                let mut scratch = self.scratch();
                receivers.map(|i| self.receiver(level, i, &before, &out.links, &mut scratch)).collect()
            };
            let is_last = level + 1 == self.points.levels.len();
            let fits = |receiver: &Receiver| self.fits(receiver);
            let chunks = SourceLevel { range: range.clone(), is_last, gather: &gather, fits: &fits };
            let (found, sent) = compute_parts(&chunks, &job, watch).await?;
            traffic.add(sent);
            // Without results only where this process needs none.
            let found = found.into_iter().flatten().flat_map(|chunk| chunk.0);
            for (i, mut receiver) in range.zip(found) {
                out.links[i] = std::mem::take(&mut receiver.links);
                out.rays += receiver.rays;
                before.push(receiver);
            }
        }
        job.reporter.sent(Stage::Sources, None, traffic);
        Ok(out)
    }

    fn scratch(&self) -> SourceScratch {
        let seen = vec![GroupSeen::default(); self.sources.groups.len()];
        SourceScratch { assigned: Vec::new(), seen, tolerances: Vec::new() }
    }

    /// Measures the typical irradiance from each source at the receivers of the coarsest level, and whether the sky is
    /// seen at all.
    fn measure(&mut self, range: Range<usize>, most: &[Vec3]) {
        let count = range.len().max(1) as f32;
        let totals = |i: usize| {
            let point = &self.points.points[i];
            let sky = || {
                see_sky(
                    self.surfaces,
                    point,
                    (i, self.points.levels.len()),
                    &self.bins,
                    &[],
                    self.settings.seed,
                )
            };
            let sky: f32 = if self.sources.has_sky { sky().irradiance.iter().sum() } else { 0.0 };
            let mut scratch = self.scratch();
            self.emitted(0, i, &mut scratch);
            (sky, scratch.seen)
        };
        let totals: Vec<(f32, Vec<GroupSeen>)> = range.into_par_iter().map(totals).collect();
        let sky = totals.iter().map(|total| total.0).sum::<f32>() / count;
        self.sources.has_sky &= sky >= LEAST_SKY;
        let mut typical = vec![sky; self.sources.sky_bins()];
        for (number, group) in self.sources.groups.iter().enumerate() {
            let sum: Vec3 = totals.iter().map(|total| total.1[number].irradiance).sum();
            // A group of one colour is measured in its brightest channel.
            let mean = sum / count;
            typical.extend(match group.is_coloured {
                true => mean.to_array().to_vec(),
                false => vec![mean.max_element()],
            });
        }
        let mut of_groups = typical[self.sources.sky_bins()..].iter().copied();
        let steps = self.sources.groups.iter().zip(most).map(|(group, most)| {
            let mut next = |most: f32| self.step(of_groups.next().unwrap_or_default(), PI * most);
            match group.is_coloured {
                true => most.to_array().map(next),
                false => in_proportion(*most, next(most.max_element())),
            }
        });
        let steps: Vec<[f32; 3]> = steps.collect();
        self.sources.groups.iter_mut().zip(steps).for_each(|(group, step)| group.step = step);
        self.sources.sky_step = self.step(if self.sources.has_sky { sky } else { 0.0 }, PI);
        self.typical = typical;
    }

    /// Estimates the irradiance of a receiver from each group; returns the number of rays.
    fn emitted(&self, level: usize, i: usize, scratch: &mut SourceScratch) -> u64 {
        let Some(emission) = &self.emission else { return 0 };
        let point = &self.points.points[i];
        let SourceScratch { assigned, seen, .. } = scratch;
        emission.see(self.surfaces, (point, i), self.emitter_rays(level), self.settings.seed, assigned, seen)
    }

    /// As [`Self::emitted`], with more rays where the visibility is uncertain, and drawn to the parents' visibility by as
    /// much as it is.
    fn emitted_beside(&self, level: usize, i: usize, parents: &[Vec3], scratch: &mut SourceScratch) -> u64 {
        let mut rays = self.emitted(level, i, scratch);
        let Some(emission) = &self.emission else { return rays };
        let (point, seed) = (&self.points.points[i], self.settings.seed);
        let SourceScratch { assigned, seen, tolerances } = scratch;
        let expected: Vec<Vec3> = parents
            .iter()
            .zip(&*seen)
            .map(|(parent, seen)| known(*parent, seen.visibility(Vec3::ONE)))
            .collect();
        tolerances.clear();
        let significance = self.settings.significance;
        tolerances.extend(self.sources.groups.iter().map(|group| CLEAR * Vec3::from(group.step) / STEP));
        let cast = self.emitter_rays(level);
        rays +=
            emission.look_again(self.surfaces, (point, i), cast, seed, &expected, tolerances, assigned, seen);
        for (seen, expected) in seen.iter_mut().zip(&expected) {
            *seen = seen.towards(*expected, significance);
        }
        rays
    }

    fn emitter_rays(&self, level: usize) -> u32 {
        let [most, least] = self.settings.emitter_rays;
        (most >> (2 * level).min(31)).max(least)
    }

    /// Step of links from a source of typical irradiance; `most` is its greatest possible irradiance.
    fn step(&self, typical: f32, most: f32) -> f32 {
        (STEP * self.settings.epsilon * typical).max(most / MAX_STEPS as f32)
    }

    /// ε of a level for a source of typical irradiance.
    fn epsilon(&self, level: usize, typical: f32) -> f32 {
        let coarser = self.points.levels.len() - 1 - level;
        self.settings.epsilon * typical * COARSER.powi(coarser as i32)
    }

    /// Whether the values of a receiver's parents differ by more than ε: parents on the two sides of a wall may both be as
    /// predicted, and their mean is neither's.
    fn do_parents_differ(&self, level: usize, row: &[Entry], before: &[Receiver]) -> bool {
        let differ = |of: &dyn Fn(&Receiver) -> f32, typical: f32| {
            let values = row.iter().map(|entry| of(&before[entry.point()]));
            let (least, most) =
                values.fold((f32::MAX, f32::MIN), |(l, m), value| (l.min(value), m.max(value)));
            most - least > self.epsilon(level, typical).max(0.5 * STEP * self.settings.epsilon * typical)
        };
        (self.sources.has_sky && differ(&|parent| parent.sky, self.typical[0]))
            || (self.sources.sky_bins()..self.typical.len())
                .any(|sender| differ(&|parent| parent.value[sender], self.typical[sender]))
    }

    /// Mean visibility of each group at the parents, by channel; NaN where none of them knows it.
    fn parents_visibility(&self, row: &[Entry], before: &[Receiver]) -> Vec<Vec3> {
        let mean = |group: usize| {
            let [mut sum, mut weights] = [Vec3::ZERO; 2];
            for entry in row {
                let visibility = before[entry.point()].visibility[group];
                let is_known = !visibility.is_nan_mask();
                sum += Vec3::select(is_known, entry.weight() * visibility, Vec3::ZERO);
                weights += Vec3::select(is_known, Vec3::splat(entry.weight()), Vec3::ZERO);
            }
            sum / weights
        };
        (0..self.sources.groups.len()).map(mean).collect()
    }

    /// Whether a message has as many values as there are sources.
    fn fits(&self, receiver: &Receiver) -> bool {
        receiver.links.iter().all(|link| link.sender() < self.typical.len())
            && [0, self.typical.len()].contains(&receiver.value.len())
            && [0, self.sources.groups.len()].contains(&receiver.visibility.len())
    }

    /// Links and values of receiver `i`, from those of the levels `before`.
    fn receiver(
        &self,
        level: usize,
        i: usize,
        before: &[Receiver],
        links: &[Vec<SourceLink>],
        scratch: &mut SourceScratch,
    ) -> Receiver {
        let row = self.relations.push().row(i);
        let is_last = level + 1 == self.points.levels.len();
        let total: f32 = row.iter().map(|entry| entry.weight()).sum();
        let mut value = vec![0.0; self.typical.len()];
        for entry in row {
            let (parent, weight) = (&before[entry.point()], entry.weight() / total);
            value.iter_mut().zip(&parent.value).for_each(|(value, of)| *value += weight * of);
        }
        let parents: Vec<(&Openings, f32)> = row
            .iter()
            .filter_map(|entry| Some((before[entry.point()].openings.as_deref()?, entry.weight())))
            .collect();
        let is_wanted = level < ALL
            || row.is_empty()
            || row.iter().any(|entry| !links[entry.point()].is_empty())
            || self.do_parents_differ(level, row, before);
        let visibility = self.parents_visibility(row, before);
        if !is_wanted {
            if is_last {
                return Receiver::default();
            }
            // Those of the nearest parent: a mean of several would look partly hidden to the children.
            let nearest = parents.iter().max_by(|a, b| a.1.total_cmp(&b.1));
            let openings = nearest.map(|(openings, _)| Box::new(**openings));
            let sky = value.iter().take(self.sources.sky_bins()).sum();
            return Receiver { value, sky, openings, visibility, ..Receiver::default() };
        }
        let mut out = Receiver::default();
        if self.sources.has_sky {
            let point = &self.points.points[i];
            let coarser = self.points.levels.len() - 1 - level;
            let seen = see_sky(self.surfaces, point, (i, coarser), &self.bins, &parents, self.settings.seed);
            out.rays += seen.rays;
            let quantizer = Quantizer {
                epsilon: self.epsilon(level, self.typical[0]),
                step: self.sources.sky_step,
                significance: MANY_BINS * self.settings.significance,
            };
            quantizer.row(0, (&seen.irradiance, &seen.variance), &value[..BINS], &mut out.links);
            out.links
                .iter()
                .for_each(|link| value[link.sender()] += link.steps() as f32 * self.sources.sky_step);
            out.openings = (!is_last).then(|| Box::new(seen.openings));
        }
        let mut sender = self.sources.sky_bins();
        out.rays += self.emitted_beside(level, i, &visibility, scratch);
        for (group, seen) in self.sources.groups.iter().zip(&scratch.seen) {
            // A group of one colour is measured in its brightest channel.
            let brightest = Vec3::from(group.step).max_position();
            for channel in if group.is_coloured { 0..3 } else { brightest..brightest + 1 } {
                let (step, own) = (group.step[channel], seen.irradiance[channel]);
                let significance = self.settings.significance;
                let quantizer =
                    Quantizer { epsilon: self.epsilon(level, self.typical[sender]), step, significance };
                let noise = significance * significance * seen.variance[channel];
                if step > 0.0 && (own - value[sender]).powi(2) > noise {
                    let begin = out.links.len();
                    quantizer.row(sender as u32, (&[own], &[0.0]), &[value[sender]], &mut out.links);
                    out.links[begin..].iter().for_each(|link| value[sender] += link.steps() as f32 * step);
                }
                sender += 1;
            }
        }
        if !is_last {
            out.sky = value.iter().take(self.sources.sky_bins()).sum();
            out.value = value;
            let own = scratch.seen.iter().zip(&visibility).map(|(seen, parents)| seen.visibility(*parents));
            out.visibility = own.collect();
        }
        out
    }
}

/// A visibility, or `otherwise` where it is not known.
fn known(visibility: Vec3, otherwise: Vec3) -> Vec3 {
    Vec3::select(visibility.is_nan_mask(), otherwise, visibility)
}

/// Steps by channel in the proportions of a colour, `step` for the brightest; zero for black, as of a texture without light.
fn in_proportion(colour: Vec3, step: f32) -> [f32; 3] {
    (colour * (step / colour.max_element().max(f32::MIN_POSITIVE))).to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_group_without_light_has_no_step() {
        assert_eq!(in_proportion(Vec3::ZERO, 0.0), [0.0; 3]);
        assert_eq!(in_proportion(Vec3::new(8.0, 4.0, 0.0), 0.25), [0.25, 0.125, 0.0]);
    }
}
