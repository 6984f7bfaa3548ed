//! Progress of the stages of a job.

use super::communicator::share::Traffic;
use super::stage::Stage;
use super::watch::Watch;

/// Amount of work of a later stage, known before the stage begins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Work {
    /// Rays of the gathers of a level.
    Rays {
        /// Level of the receivers.
        level: usize,
        /// Number of rays.
        rays: u64,
    },
    /// Later bounces between coarse points.
    Multibounce {
        /// Columns of the coarse transport matrix with an entry.
        columns: usize,
        /// Entries of the matrix.
        entries: usize,
    },
}

/// Receives the progress of a job, and may cancel the job.
pub trait Reporter: Sync {
    /// Begins a stage, on a level where the stage has levels. The stage ends when the returned watch is dropped.
    fn begin(&self, stage: Stage, level: Option<usize>) -> Box<dyn Watch + '_>;

    /// Receives the amount of later work.
    fn expect(&self, _work: Work) {}

    /// Receives the number of bytes that a stage has sent between processes.
    fn sent(&self, _stage: Stage, _level: Option<usize>, _traffic: Traffic) {}
}

/// Reports to nobody.
impl Reporter for () {
    fn begin(&self, _stage: Stage, _level: Option<usize>) -> Box<dyn Watch + '_> {
        Box::new(())
    }
}

/// Forwards cancellation to a watch, without counting: for a small job within a larger computation.
pub struct Quiet<'a>(pub &'a dyn Watch);

impl Reporter for Quiet<'_> {
    fn begin(&self, _stage: Stage, _level: Option<usize>) -> Box<dyn Watch + '_> {
        Box::new(super::watch::Uncounted(self.0))
    }
}
