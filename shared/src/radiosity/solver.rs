//! The passes of a solution in order: bounce after bounce, each from the coarsest level to finer ones.
//!
//! The 2011 paper gathers for every bounce on all levels. Later bounces are smooth: here by default all bounces but the last
//! are gathered on the levels but the finest, and one pass over all levels then gathers the sum of all unshot light. It has
//! the same light with a fraction of the gathers ([`Passes`]).

use super::accelerator::Accelerator;
use super::gather::{Gather, Gathered};
use super::levels::{is_refined, is_wanted, pulled_down, significant};
use super::reconstruction::{Reconstruction, Senders};
use crate::baked::BakedScene;
use crate::motion::Motions;
use crate::rbn::bulk::Point;
use glam::Vec3;

/// Which levels a bounce is gathered on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Passes {
    /// Every bounce on all levels, as the 2011 paper does.
    EachBounce,
    /// Bounces on the coarser levels, then the sum of them once on all levels.
    #[default]
    Summed,
}

/// Settings of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RadiositySettings {
    /// Rays of a receiver.
    pub rays: u32,
    /// Bounces of light, at least one; those that follow are taken to keep the last two bounces' ratio.
    pub bounces: u32,
    /// Level of the senders, counted from the finest one: 0 is the finest. What is known of direct light there costs nothing;
    /// a small object may have no coarser point on its lit side.
    pub senders_above: usize,
    /// Finest level that all bounces but the last are gathered on, counted as above: points of finer levels have what their
    /// parents have.
    pub bounces_above: usize,
    /// Relative difference from the parents at which a point's children are gathered for.
    pub epsilon: f32,
    /// Standard deviations of its noise that a difference must stand out of.
    pub significance: f32,
    /// How light at hits is taken from the points.
    pub reconstruction: Reconstruction,
    /// Which levels a bounce is gathered on.
    pub passes: Passes,
}

impl Default for RadiositySettings {
    fn default() -> Self {
        Self {
            rays: 512,
            bounces: 6,
            senders_above: 0,
            bounces_above: 1,
            epsilon: 0.1,
            significance: 0.25,
            reconstruction: Reconstruction::default(),
            passes: Passes::default(),
        }
    }
}

impl RadiositySettings {
    /// Level of the senders, of so many levels.
    pub fn sender_level(&self, levels: usize) -> usize {
        levels.saturating_sub(1).saturating_sub(self.senders_above)
    }

    /// Number of coarsest levels that all bounces but the last are gathered on.
    pub fn levels_of_bounces(&self, levels: usize) -> usize {
        levels.saturating_sub(1).saturating_sub(self.bounces_above) + 1
    }
}

/// Number of coarsest levels whose points are all gathered for.
pub const WHOLE_LEVELS: usize = 2;
/// Most that a bounce is taken to keep of the one before.
pub const MOST_KEPT: f32 = 0.95;
/// Most that two bounces are taken to bring together, as a multiple of the second.
pub const MOST_PAIR: f32 = 16.0;

/// What the bounces after the last one bring, as a multiple of it; `means` are the mean irradiances of the bounces. Light that
/// has bounced often has one shape and loses one share a bounce: that of the transport's largest eigenvalue.
pub fn further(means: &[f32]) -> f32 {
    match means {
        // By pairs of bounces: light may go to and fro between a floor and a ceiling.
        [.., first, before, last] => {
            let kept = (last / first.max(1e-30)).clamp(0.0, MOST_KEPT * MOST_KEPT);
            (1.0 + before / last.max(1e-30)).min(MOST_PAIR) * kept / (1.0 - kept)
        }
        [before, last] => {
            let kept = (last / before.max(1e-30)).clamp(0.0, MOST_KEPT);
            kept / (1.0 - kept)
        }
        _ => 0.0,
    }
}

/// Bounced light of all points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solution {
    /// Bounced irradiance along each point's normal, linear RGB.
    pub irradiance: Vec<Vec3>,
    /// Number of gathers in all passes.
    pub gathers: u64,
    /// Bounces.
    pub bounces: u32,
}

/// Gathers for many receivers: calls the function for each of them, in any order, and returns the results in theirs.
pub type GatherAll<'a> = &'a dyn Fn(&[u32], &(dyn Fn(u32) -> Gathered + Sync)) -> Vec<Gathered>;

/// A scene to solve for.
#[derive(Clone, Copy, Debug)]
pub struct Scene<'a> {
    /// The file's contents; where groups have moved, with [the functions of then](super::ClippedFunctions).
    pub baked: &'a BakedScene,
    /// BVHs of its models.
    pub accelerator: &'a Accelerator,
    /// Where its groups are.
    pub motions: &'a Motions,
}

/// Solves for the bounced light of all points. `direct` is the direct irradiance of each point, RGB.
pub fn solve(
    scene: Scene<'_>,
    settings: &RadiositySettings,
    direct: &[Vec3],
    all: GatherAll<'_>,
) -> Solution {
    let Scene { baked, accelerator, motions } = scene;
    let levels = baked.meta.levels.len();
    if levels == 0 {
        return Solution::default();
    }
    let placed = accelerator.placed(baked, motions);
    let points: Vec<Point> = (0..baked.points.len()).map(|i| baked.moved_point(i, motions)).collect();
    let solver = Solver {
        baked,
        settings,
        all,
        gather: Gather {
            accelerator,
            placed: &placed,
            senders: Senders {
                lookup: &baked.relations.lookup,
                points: &points,
                cuts: &baked.cuts,
                level: settings.sender_level(levels),
                levels,
            },
            finest_radius: baked.meta.levels[levels - 1].support_radius,
            reconstruction: settings.reconstruction,
            rays: settings.rays.max(1),
            pass: 0,
        },
    };
    match settings.passes {
        Passes::EachBounce => solver.each_bounce(direct),
        Passes::Summed => solver.summed(direct),
    }
}

struct Solver<'a> {
    baked: &'a BakedScene,
    settings: &'a RadiositySettings,
    all: GatherAll<'a>,
    gather: Gather<'a>,
}

impl Solver<'_> {
    /// The light that points send.
    fn sent(&self, unshot: &[Vec3]) -> Vec<Vec3> {
        unshot.iter().enumerate().map(|(i, e)| self.baked.albedo(i) * *e).collect()
    }

    fn each_bounce(&self, direct: &[Vec3]) -> Solution {
        let bounces = self.settings.bounces.max(1);
        let mut out = Solution { irradiance: vec![Vec3::ZERO; direct.len()], gathers: 0, bounces };
        let (mut unshot, mut means) = (direct.to_vec(), Vec::new());
        for bounce in 0..bounces {
            unshot = self.pass(bounce, &unshot, self.gather.senders.levels, &mut out.gathers);
            means.push(self.mean(&unshot));
            let factor = if bounce + 1 == bounces { 1.0 + further(&means) } else { 1.0 };
            out.irradiance.iter_mut().zip(&unshot).for_each(|(sum, light)| *sum += factor * *light);
        }
        out
    }

    fn summed(&self, direct: &[Vec3]) -> Solution {
        let bounces = self.settings.bounces.max(1);
        let levels = self.gather.senders.levels;
        let mut out = Solution { bounces, ..Solution::default() };
        let (mut unshot, mut sum, mut means) = (direct.to_vec(), direct.to_vec(), Vec::new());
        for bounce in 1..bounces {
            unshot = self.pass(bounce, &unshot, self.settings.levels_of_bounces(levels), &mut out.gathers);
            means.push(self.mean(&unshot));
            let factor = if bounce + 1 == bounces { 1.0 + further(&means) } else { 1.0 };
            sum.iter_mut().zip(&unshot).for_each(|(sum, light)| *sum += factor * *light);
        }
        out.irradiance = self.pass(0, &sum, self.gather.senders.levels, &mut out.gathers);
        out
    }

    /// Mean irradiance of the coarsest level.
    fn mean(&self, values: &[Vec3]) -> f32 {
        let range = self.baked.level(0);
        let count = range.len().max(1) as f32;
        values[range].iter().map(|e| e.element_sum() / 3.0).sum::<f32>() / count
    }

    /// One bounce of unshot light, gathered on the `levels` coarsest levels as far as the oracle asks for it, and pulled down
    /// to all others.
    fn pass(&self, pass: u32, unshot: &[Vec3], levels: usize, gathers: &mut u64) -> Vec<Vec3> {
        let gather = Gather { pass, ..self.gather };
        let (light, push) = (self.sent(unshot), self.baked.push());
        let mut values = vec![Vec3::ZERO; unshot.len()];
        let mut refined = vec![false; unshot.len()];
        let mut mean = 0.0;
        for level in 0..self.gather.senders.levels {
            let range = self.baked.level(level);
            let is_whole = level < WHOLE_LEVELS;
            let wanted: Vec<u32> = match level < levels {
                true => range
                    .clone()
                    .filter(|i| is_whole || is_wanted(push, *i, &refined))
                    .map(|i| i as u32)
                    .collect(),
                false => Vec::new(),
            };
            let found = (self.all)(&wanted, &|receiver| gather.irradiance(receiver, &light));
            *gathers += wanted.len() as u64;
            for i in range {
                values[i] = pulled_down(push, i, &values).unwrap_or(Vec3::ZERO);
            }
            if level == 0 {
                let sum: f32 = found.iter().map(|found| found.irradiance.element_sum() / 3.0).sum();
                mean = sum / found.len().max(1) as f32;
            }
            for (receiver, found) in wanted.iter().zip(&found) {
                let i = *receiver as usize;
                let has_parents = !push.row(i).is_empty();
                let value = if has_parents {
                    significant(found, values[i], self.settings.significance)
                } else {
                    found.irradiance
                };
                refined[i] = !has_parents || is_refined(value, values[i], self.settings.epsilon, mean);
                values[i] = value;
            }
        }
        values
    }
}

#[cfg(test)]
mod tests {
    use super::further;

    /// The bounces after the first `seen` ones of an endless series, as a multiple of the last of these.
    fn rest(series: impl Fn(u32) -> f32, seen: u32) -> f32 {
        (seen..200).map(&series).sum::<f32>() / series(seen - 1)
    }

    #[test]
    fn a_series_that_loses_one_share_a_bounce_is_continued_to_its_end() {
        let series = |bounce: u32| 3.0 * 0.6f32.powi(bounce as i32);
        for seen in 2..7 {
            let means: Vec<f32> = (0..seen).map(series).collect();
            assert!((further(&means) / rest(series, seen) - 1.0).abs() < 1e-4, "{seen}");
        }
        assert_eq!(further(&[1.0]), 0.0);
    }

    #[test]
    fn light_to_and_fro_between_two_surfaces_is_continued_by_pairs() {
        // A bright floor under a dark ceiling: every second bounce is weak.
        let series =
            |bounce: u32| if bounce.is_multiple_of(2) { 1.0 } else { 0.3 } * 0.4f32.powi(bounce as i32 / 2);
        for seen in 3..8 {
            let means: Vec<f32> = (0..seen).map(series).collect();
            assert!((further(&means) / rest(series, seen) - 1.0).abs() < 1e-4, "{seen}");
        }
    }
}
