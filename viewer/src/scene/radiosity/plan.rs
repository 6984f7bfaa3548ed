//! The steps of a solution in order, as [`rebounce_shared::radiosity::solver`] has them, cut into slices.

use rebounce_shared::radiosity::solver::{Passes, RadiositySettings, WHOLE_LEVELS};
use std::ops::Range;

/// What a step runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SolverKernel {
    /// gather_light.wgsl, at points of a level.
    Gather,
    /// pull_down.wgsl, at points of a level.
    PullDown,
    /// bounce_mean.wgsl.
    Mean,
    /// show_light.wgsl.
    Show,
    /// send_light.wgsl, from direct light or from the bounce before.
    Send { from_direct: bool },
}

/// A step: the kernel, its points, and its part of `Pass` in radiosity_pass.wgsl.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SolverStep {
    pub kernel: SolverKernel,
    pub first: u32,
    pub count: u32,
    pub number: u32,
    pub is_whole: bool,
    pub is_none: bool,
    pub factor: f32,
    pub bounce: u32,
}

/// How far a solution is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Progress {
    /// Number of finished passes, and of all passes.
    pub passes: [u32; 2],
    /// Whether there is light to show, coarse as it may be.
    pub is_shown: bool,
    /// Whether the solution is whole.
    pub is_done: bool,
}

/// The steps of a solution.
#[derive(Debug)]
pub(super) struct Plan {
    levels: Vec<Range<usize>>,
    sender_level: usize,
    steps: Vec<SolverStep>,
    /// Next step, and next point of it.
    next: (usize, u32),
    /// Whether the last pass has all light; otherwise the sum of the bounces has.
    ends_in_values: bool,
}

impl Plan {
    /// The steps for levels of points.
    pub fn new(levels: Vec<Range<usize>>, settings: &RadiositySettings) -> Self {
        let sender_level = settings.sender_level(levels.len());
        let of_bounces = settings.levels_of_bounces(levels.len());
        let steps = Vec::new();
        let ends_in_values = settings.passes == Passes::Summed;
        let mut plan = Self { levels, sender_level, steps, next: (0, 0), ends_in_values };
        let bounces = settings.bounces.max(1);
        match settings.passes {
            Passes::Summed => plan.summed(bounces, of_bounces),
            Passes::EachBounce => plan.each_bounce(bounces),
        }
        plan
    }

    pub fn sender_level(&self) -> usize {
        self.sender_level
    }

    fn summed(&mut self, bounces: u32, gathered: usize) {
        self.send(true, 0.0, bounces == 1, 0);
        for bounce in 1..bounces {
            self.pass(bounce, bounce - 1, gathered);
            let is_last = bounce + 1 == bounces;
            self.send(false, if is_last { 2.0 } else { 1.0 }, is_last, bounce - 1);
        }
        self.pass(0, bounces.saturating_sub(2), self.levels.len());
    }

    fn each_bounce(&mut self, bounces: u32) {
        self.send(true, 0.0, false, 0);
        for bounce in 0..bounces {
            self.pass(bounce, bounce, self.levels.len());
            self.send(false, if bounce + 1 == bounces { 2.0 } else { 1.0 }, false, bounce);
        }
    }

    fn send(&mut self, from_direct: bool, factor: f32, is_sum: bool, bounce: u32) {
        let count = self.levels.last().map_or(0, |level| level.end) as u32;
        let step = SolverStep {
            kernel: SolverKernel::Send { from_direct },
            first: 0,
            count,
            number: 0,
            is_whole: false,
            is_none: is_sum,
            factor,
            bounce,
        };
        self.steps.push(step);
    }

    /// The step that shows the solution so far: the sum of its bounces, or all light of the last pass.
    pub fn show(&self) -> SolverStep {
        let count = self.levels.last().map_or(0, |level| level.end) as u32;
        SolverStep {
            kernel: SolverKernel::Show,
            first: 0,
            count,
            number: 0,
            is_whole: false,
            is_none: !(self.progress().is_done && self.ends_in_values),
            factor: 0.0,
            bounce: 0,
        }
    }

    /// A bounce, gathered on the `gathered` coarsest levels and pulled down to the others.
    fn pass(&mut self, number: u32, bounce: u32, gathered: usize) {
        for (l, level) in self.levels.clone().into_iter().enumerate() {
            let step = SolverStep {
                kernel: SolverKernel::PullDown,
                first: level.start as u32,
                count: level.len() as u32,
                number,
                is_whole: l < WHOLE_LEVELS,
                is_none: l >= gathered,
                factor: 0.0,
                bounce,
            };
            self.steps.push(step);
            if l < gathered {
                self.steps.push(SolverStep { kernel: SolverKernel::Gather, ..step });
            }
            if l == 0 {
                self.steps.push(SolverStep { kernel: SolverKernel::Mean, ..step });
            }
        }
    }

    pub fn restart(&mut self) {
        self.next = (0, 0);
    }

    /// Takes the next steps: gathers for at most `receivers` points, and at most `most` steps.
    pub fn take(&mut self, receivers: u32, most: usize) -> Vec<SolverStep> {
        let (mut out, mut left) = (Vec::new(), receivers.max(1));
        while out.len() < most {
            let (place, begun) = self.next;
            let Some(step) = self.steps.get(place) else { break };
            let rest = SolverStep { first: step.first + begun, count: step.count - begun, ..*step };
            if step.kernel != SolverKernel::Gather {
                out.push(rest);
                self.next = (place + 1, 0);
                continue;
            }
            if left == 0 {
                break;
            }
            let count = rest.count.min(left);
            left -= count;
            out.push(SolverStep { count, ..rest });
            self.next = if count == rest.count { (place + 1, 0) } else { (place, begun + count) };
        }
        out
    }

    pub fn progress(&self) -> Progress {
        let sends = |steps: &[SolverStep]| {
            steps.iter().filter(|step| matches!(step.kernel, SolverKernel::Send { .. })).count() as u32
        };
        let done = sends(&self.steps[..self.next.0]);
        Progress {
            passes: [done, sends(&self.steps)],
            is_shown: done > 1,
            is_done: self.next.0 == self.steps.len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn levels() -> Vec<Range<usize>> {
        vec![0..10, 10..50, 50..300]
    }

    #[test]
    fn slices_gather_for_every_point_once_and_in_order() {
        for passes in [Passes::Summed, Passes::EachBounce] {
            let settings = RadiositySettings { bounces: 3, passes, ..RadiositySettings::default() };
            let whole = Plan::new(levels(), &settings).take(u32::MAX, usize::MAX);
            let mut plan = Plan::new(levels(), &settings);
            let mut sliced: Vec<SolverStep> = Vec::new();
            while !plan.progress().is_done {
                let slice = plan.take(7, 64);
                let gathered =
                    slice.iter().filter(|step| step.kernel == SolverKernel::Gather).map(|step| step.count);
                assert!(gathered.sum::<u32>() <= 7 && !slice.is_empty());
                for step in slice {
                    match sliced.last_mut() {
                        Some(last)
                            if last.kernel == SolverKernel::Gather
                                && step.kernel == SolverKernel::Gather
                                && last.first + last.count == step.first =>
                        {
                            last.count += step.count
                        }
                        _ => sliced.push(step),
                    }
                }
            }
            assert_eq!(sliced, whole);
            plan.restart();
            assert!(!plan.progress().is_done && plan.progress().passes[0] == 0);
        }
    }
}
