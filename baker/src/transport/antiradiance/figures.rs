//! What a solution took: the columns of Tables 1 and 2 of Dachsbacher et al. 2007.

use crate::job::clock;
use crate::job::watch::{Stopped, Watch};
use glam::Vec3;
use rebounce_shared::antiradiance::{Observer, Pass};
use std::time::Duration;

/// Figures of a solution, of all groups of light together.
#[derive(Clone, Debug, Default)]
pub struct AntiradianceWork {
    /// Bins of directions.
    pub bins: usize,
    /// Patches.
    pub patches: usize,
    /// Patches and clusters.
    pub elements: usize,
    /// Links.
    pub links: usize,
    /// Form factors of the links: one for each bin that a link uses.
    pub transfers: usize,
    /// Steps of the last group.
    pub iterations: u32,
    /// Seconds of making hierarchy, links and form factors.
    pub link_seconds: f64,
    /// Seconds of the passes: global, push, local, pull.
    pub pass_seconds: [f64; 4],
    /// Difference of each step's irradiance from the last step's, a share of it, of the last group.
    pub differences: Vec<f32>,
    /// Bytes of the tables, the form factors and the links.
    pub bytes: u64,
}

/// Follows a solution: asks whether to go on, and takes the time.
pub(super) struct Follower<'a> {
    watch: &'a dyn Watch,
    last: Duration,
    /// Seconds by pass.
    pub seconds: [f64; 4],
    /// Irradiance after each step.
    pub steps: Vec<Vec<Vec3>>,
    /// Whether it was stopped.
    pub stopped: Result<(), Stopped>,
}

impl<'a> Follower<'a> {
    pub(super) fn new(watch: &'a dyn Watch) -> Self {
        Self { watch, last: clock::wall(), seconds: [0.0; 4], steps: Vec::new(), stopped: Ok(()) }
    }
}

impl Observer for Follower<'_> {
    fn passed(&mut self, pass: Pass) {
        let now = clock::wall();
        self.seconds[pass as usize] += (now - self.last).as_secs_f64();
        self.last = now;
    }

    fn stepped(&mut self, irradiance: &[Vec3]) -> bool {
        self.steps.push(irradiance.to_vec());
        self.stopped = self.watch.step(0);
        self.last = clock::wall();
        self.stopped.is_ok()
    }
}
