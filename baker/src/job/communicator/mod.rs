//! Communicator: processes that bake one scene together.
//!
//! Every member has the complete scene and the same points. Module [`share`] splits the work;
//! [`Communicator::exchange`] sends the results, as bytes, to the members that need them. Processes block while they
//! wait; workers of a web page suspend the bake, which is a future ([`Baker::bake_async`](crate::bake::Baker)).
//!
//! * [`share`] – work split between members, with exchange of results;
//! * [`slices`] – messages longer than the maximum message size;
//! * `mpi` – members started by `mpirun`; only with the feature `mpi`.

#[cfg(feature = "mpi")]
pub mod mpi;
pub mod share;
pub mod slices;

use crate::job::watch::{Stopped, Watch};
use std::pin::Pin;
use std::task::{Context, Poll, Waker};

/// The processes of one bake. All members call [`Self::exchange`] equally often, each from one thread. Member 0 keeps
/// the checkpoint and writes the file.
pub trait Communicator {
    /// Returns the rank of this member, from 0.
    fn rank(&self) -> usize;

    /// Returns the number of members.
    fn size(&self) -> usize;

    /// Whether [`Self::exchange`] blocks the calling thread, so that its future is ready when first polled. Members
    /// that can not block, the workers of a web page, receive messages only while their thread computes nothing.
    fn is_blocking(&self) -> bool {
        true
    }

    /// Sends `to_first` to member 0 and `to_all` to all members, and waits for the messages of the other members. Calls
    /// `watch` while waiting, if blocking.
    fn exchange<'a>(&'a self, to_first: &'a [u8], to_all: &'a [u8], watch: &'a dyn Watch) -> Exchange<'a>;
}

/// The messages of one exchange, to be awaited; [`Stopped`] makes the job unusable.
pub type Exchange<'a> = Pin<Box<dyn Future<Output = Result<Received, Stopped>> + 'a>>;

/// Runs a future that waits for nothing but [blocking](Communicator::is_blocking) communicators: polls it once. `None` if
/// it waits for something else.
pub fn run_blocking<T>(future: impl Future<Output = T>) -> Option<T> {
    match std::pin::pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(result) => Some(result),
        Poll::Pending => None,
    }
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

    fn exchange<'a>(&'a self, to_first: &'a [u8], to_all: &'a [u8], _watch: &'a dyn Watch) -> Exchange<'a> {
        let received = Received { to_first: vec![to_first.to_vec()], to_all: vec![to_all.to_vec()] };
        Box::pin(std::future::ready(Ok(received)))
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
    /// Members that do not block were given to a function that blocks.
    #[error("the other members answer only while this thread waits: bake with Baker::bake_async")]
    WouldBlock,
    /// A member works on other data.
    #[error(
        "process {0} works on another scene, or has come to other points: start all processes from the same program with the same arguments, on processors of one kind"
    )]
    Apart(usize),
}
