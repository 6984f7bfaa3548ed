//! Communicator: processes that bake one scene together.
//!
//! Every member has the complete scene and the same points. Module [`share`] splits the work;
//! [`Communicator::exchange`] sends the results, as bytes, to the members that need them.
//!
//! * [`share`] – work split between members, with exchange of results;
//! * [`slices`] – messages longer than the maximum message size;
//! * `mpi` – members started by `mpirun`; only with the feature `mpi`.

#[cfg(feature = "mpi")]
pub mod mpi;
pub mod share;
pub mod slices;

use crate::job::watch::{Stopped, Watch};

/// The processes of one bake. All members call [`Self::exchange`] equally often, each from one thread. Member 0 keeps
/// the checkpoint and writes the file.
pub trait Communicator {
    /// Returns the rank of this member, from 0.
    fn rank(&self) -> usize;

    /// Returns the number of members.
    fn size(&self) -> usize;

    /// Sends `to_first` to member 0 and `to_all` to all members, and waits for the messages of the other members. Calls
    /// `watch` while waiting.
    ///
    /// # Errors
    /// [`Stopped`]; the job is unusable afterwards.
    fn exchange(&self, to_first: &[u8], to_all: &[u8], watch: &dyn Watch) -> Result<Received, Stopped>;
}

/// Messages of one exchange, by sending member, including the receiving member itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Received {
    /// Messages to member 0; empty on the other members.
    pub to_first: Vec<Vec<u8>>,
    /// Messages to all members.
    pub to_all: Vec<Vec<u8>>,
}

/// A single process.
impl Communicator for () {
    fn rank(&self) -> usize {
        0
    }

    fn size(&self) -> usize {
        1
    }

    fn exchange(&self, to_first: &[u8], to_all: &[u8], _watch: &dyn Watch) -> Result<Received, Stopped> {
        Ok(Received { to_first: vec![to_first.to_vec()], to_all: vec![to_all.to_vec()] })
    }
}

/// Reason for unfinished work in a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CommunicatorError {
    /// The observer stopped the work.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A member sent invalid data.
    #[error(
        "process {0} sent what is no part of this bake: start all processes from the same program, with the same arguments"
    )]
    Garbled(usize),
    /// A member works on other data.
    #[error(
        "process {0} works on another scene, or has come to other points: start all processes from the same program with the same arguments, on processors of one kind"
    )]
    Apart(usize),
}
