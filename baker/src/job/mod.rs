//! Running a long computation: progress and cancellation, finished parts on disk, and several processes. Knows no
//! geometry.
//!
//! * [`watch`] – counts work, and cancels; [`stage`] – the stages of a bake; [`reporter`] – receives their progress;
//! * [`parts`] – computes the parts of a stage on all processes, with the partial results of earlier runs;
//! * [`partial_results`] – storage of finished parts; [`checkpoint`] – partial results on disk;
//! * [`communicator`] – the processes of a job; [`bytes`] – numbers as bytes;
//! * [`clock`] – wall clock and processor time.

pub mod bytes;
pub mod checkpoint;
pub mod clock;
pub mod communicator;
pub mod partial_results;
pub mod parts;
pub mod reporter;
pub mod stage;
pub mod watch;

use communicator::{Communicator, CommunicatorError};
use partial_results::PartialResults;
use reporter::Reporter;
use watch::Watch;

/// The surroundings of a long computation. The default runs on this process alone, reports to nobody and stores nothing.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    /// Receives the progress of the stages, and may cancel.
    pub reporter: &'a dyn Reporter,
    /// Storage of finished parts.
    pub partial_results: &'a dyn PartialResults,
    /// The processes that compute together.
    pub communicator: &'a dyn Communicator,
}

impl Default for Job<'_> {
    fn default() -> Self {
        Self { reporter: &(), partial_results: &(), communicator: &() }
    }
}

impl Job<'_> {
    /// Checks that all processes have the same `digest`.
    ///
    /// # Errors
    /// [`CommunicatorError::Apart`] with the first process whose digest differs from the digest of process 0.
    pub async fn agree(&self, digest: &[u8], watch: &dyn Watch) -> Result<(), CommunicatorError> {
        if self.communicator.size() == 1 {
            return Ok(());
        }
        let received = self.communicator.exchange(&[], digest, watch).await?;
        match received.to_all.iter().position(|other| *other != received.to_all[0]) {
            Some(member) => Err(CommunicatorError::Apart(member)),
            None => Ok(()),
        }
    }
}
