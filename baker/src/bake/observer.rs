//! Interface between a running bake and the caller: progress, previews, stopping.

use crate::job::stage::Stage;
use rebounce_shared::baked::BakedScene;

/// Progress of a bake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Current stage.
    pub stage: Stage,
    /// Level of points; `None` for stages without levels.
    pub level: Option<usize>,
    /// Units done of this stage on this level.
    pub done: u64,
    /// Units of this stage on this level, as far as known.
    pub total: u64,
    /// Rays per second of the operator's gathers; `None` in other stages.
    pub rays_per_second: Option<f64>,
    /// Seconds since the bake began.
    pub seconds: f64,
    /// Estimated seconds until the bake ends.
    pub seconds_left: f64,
    /// Processor seconds since the bake began, summed over the threads of the process.
    pub processor_seconds: f64,
    /// Estimated processor seconds until the bake ends; independent of other load on the machine.
    pub processor_seconds_left: f64,
}

impl Progress {
    /// Returns the estimated share of the bake's time that has passed: 0 to 1.
    pub fn fraction(&self) -> f64 {
        self.seconds / (self.seconds + self.seconds_left).max(f64::MIN_POSITIVE)
    }
}

/// A coarse file to show during the bake.
pub struct Preview {
    /// Contents of the file. Indirect light on unfinished levels is as smooth as on the finest finished level.
    pub file: BakedScene,
    /// Number of levels with links; 0 for a sketch, which has its own points.
    pub levels: usize,
}

/// Follows a bake, and may stop the bake.
pub trait Observer: Sync {
    /// Reports progress, from any thread: at the start of every stage, then up to about twenty times per second.
    fn progress(&self, _progress: &Progress) {}

    /// Returns whether to stop the bake; called every few milliseconds.
    fn is_stopped(&self) -> bool {
        false
    }

    /// Returns whether to call [`Self::preview`].
    fn wants_previews(&self) -> bool {
        false
    }

    /// Returns whether to call [`Self::preview`] with a scene without links, for radiosity, as soon as there are points. All
    /// workers of a bake must say the same.
    fn wants_points(&self) -> bool {
        false
    }

    /// Receives a preview; each preview is finer than the previous preview. The bake waits until the call returns.
    fn preview(&self, _preview: Preview) {}
}

/// No observer.
impl Observer for () {}
