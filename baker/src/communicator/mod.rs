//! Processes that bake one scene together.
//!
//! Every member has the whole scene and the same points. The work is split by [`share`]; what one member found goes to
//! those who need it as bytes, through [`Communicator::exchange`].
//!
//! * [`share`] – work that all do parts of, and tell each other about;
//! * [`slices`] – messages that are longer than what can be sent at once;
//! * `mpi` – members that `mpirun` has started; only with the feature `mpi`.

#[cfg(feature = "mpi")]
pub mod mpi;
pub mod share;
pub mod slices;

use crate::watch::{Stopped, Watch};

/// The processes of one bake. All of them call [`Self::exchange`] equally often, each from one thread. The first member,
/// 0, keeps the checkpoint and writes the file.
pub trait Communicator {
    /// This member's number, from 0.
    fn rank(&self) -> usize;

    /// How many members there are.
    fn size(&self) -> usize;

    /// Gives `to_first` to member 0 and `to_all` to everybody, and waits for what the others give. `watch` is asked
    /// while it waits.
    ///
    /// # Errors
    /// [`Stopped`]; the team cannot be used after that.
    fn exchange(&self, to_first: &[u8], to_all: &[u8], watch: &dyn Watch) -> Result<Received, Stopped>;
}

/// What came of one exchange, by member, this one included.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Received {
    /// What was for member 0; empty elsewhere.
    pub to_first: Vec<Vec<u8>>,
    /// What was for everybody.
    pub to_all: Vec<Vec<u8>>,
}

/// One process that works alone.
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

/// Why work in a team ended before it was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CommunicatorError {
    /// Somebody asked for it.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A member sent what does not belong here.
    #[error(
        "process {0} sent what is no part of this bake: start all processes from the same program, with the same arguments"
    )]
    Garbled(usize),
}
