//! Communicator over MPI: members started by `mpirun` or another launcher of MPI programs.

use super::slices::{places, slice};
use super::{Communicator, Exchange, Received};
use crate::job::watch::{Stopped, Watch};
use mpi::Count;
use mpi::Threading;
use mpi::collective::{CommunicatorCollectives, Root};
use mpi::datatype::PartitionMut;
use mpi::environment::Universe;
use mpi::topology::{Communicator as _, SimpleCommunicator};
use std::time::Duration;

/// First and longest pause while waiting for the other members.
const PAUSE: (Duration, Duration) = (Duration::from_micros(50), Duration::from_millis(2));
/// Maximum bytes per MPI call, summed over members; MPI counts have 31 bits.
const AT_ONCE: usize = 1 << 30;
/// Buffer of empty messages: the address of an empty `Vec` may equal MPI_IN_PLACE.
static NOTHING: [u8; 1] = [0];
/// Environment variables set by launchers.
const LAUNCHED: [&str; 4] = ["OMPI_COMM_WORLD_SIZE", "PMI_RANK", "PMIX_RANK", "MPI_LOCALRANKID"];

/// Reason for a failed start of MPI.
#[derive(Debug, thiserror::Error)]
pub enum MpiError {
    /// MPI was started before in this process.
    #[error("MPI was started twice in one process: start it once")]
    Twice,
    /// The MPI library supports only single-threaded programs.
    #[error(
        "this MPI serves only programs of one thread: install one with MPI_THREAD_FUNNELED, such as Debian's Open MPI"
    )]
    OneThread,
}

/// The processes started together by the launcher.
pub struct Mpi {
    /// Finalizes MPI, together with the other members, when dropped.
    _universe: Universe,
    world: SimpleCommunicator,
}

impl Mpi {
    /// Returns whether a launcher has started this process.
    pub fn is_launched() -> bool {
        LAUNCHED.iter().any(|name| std::env::var_os(name).is_some())
    }

    /// Joins the processes started together by the launcher. Only the calling thread may use the communicator.
    ///
    /// # Errors
    /// [`MpiError`].
    pub fn join() -> Result<Self, MpiError> {
        let (universe, threading) =
            mpi::initialize_with_threading(Threading::Funneled).ok_or(MpiError::Twice)?;
        if threading < Threading::Funneled {
            return Err(MpiError::OneThread);
        }
        let world = universe.world();
        Ok(Self { _universe: universe, world })
    }

    /// Ends all processes with this exit code.
    pub fn abort(&self, code: u8) -> ! {
        self.world.abort(code.into())
    }

    /// Waits at a barrier for all members.
    fn meet(&self, watch: &dyn Watch) -> Result<(), Stopped> {
        let mut barrier = self.world.immediate_barrier();
        let mut pause = PAUSE.0;
        loop {
            match barrier.test() {
                Ok(_) => return Ok(()),
                Err(still) => barrier = still,
            }
            if let Err(stopped) = watch.step(0) {
                // The barrier is incomplete; the process ends without completing the barrier.
                std::mem::forget(barrier);
                return Err(stopped);
            }
            std::thread::sleep(pause);
            pause = PAUSE.1.min(2 * pause);
        }
    }
}

impl Communicator for Mpi {
    fn rank(&self) -> usize {
        self.world.rank() as usize
    }

    fn size(&self) -> usize {
        self.world.size() as usize
    }

    fn exchange<'a>(&'a self, to_first: &'a [u8], to_all: &'a [u8], watch: &'a dyn Watch) -> Exchange<'a> {
        Box::pin(std::future::ready(self.all_gather(to_first, to_all, watch)))
    }
}

impl Mpi {
    /// Exchanges messages; blocks until all members have sent theirs.
    fn all_gather(&self, to_first: &[u8], to_all: &[u8], watch: &dyn Watch) -> Result<Received, Stopped> {
        self.meet(watch)?;
        let (size, first) = (self.size(), self.world.process_at_rank(0));
        let mut lengths = vec![0u64; 2 * size];
        self.world.all_gather_into(&[to_first.len() as u64, to_all.len() as u64], &mut lengths[..]);
        let length = |member: usize, kind: usize| lengths[2 * member + kind] as usize;
        let most = AT_ONCE / size;
        let is_first = self.rank() == 0;
        let mut received = Received { to_first: Vec::new(), to_all: vec![Vec::new(); size] };
        if is_first {
            received.to_first = vec![Vec::new(); size];
        }
        for (kind, message) in [to_first, to_all].into_iter().enumerate() {
            let longest = (0..size).map(|member| length(member, kind)).max().unwrap_or(0);
            for round in 0..longest.div_ceil(most) {
                let counts: Vec<Count> =
                    (0..size).map(|member| slice(length(member, kind), round, most).len() as Count).collect();
                let mine = match slice(message.len(), round, most) {
                    part if part.is_empty() => &NOTHING[..0],
                    part => &message[part],
                };
                if kind == 0 && !is_first {
                    first.gather_varcount_into(mine);
                    continue;
                }
                let places = places(&counts);
                let mut bytes = vec![0u8; counts.iter().map(|count| *count as usize).sum()];
                let mut parts = PartitionMut::new(&mut bytes[..], &counts[..], &places[..]);
                let into = if kind == 0 {
                    first.gather_varcount_into_root(mine, &mut parts);
                    &mut received.to_first
                } else {
                    self.world.all_gather_varcount_into(mine, &mut parts);
                    &mut received.to_all
                };
                for ((into, at), count) in into.iter_mut().zip(places).zip(counts) {
                    into.extend_from_slice(&bytes[at as usize..][..count as usize]);
                }
            }
        }
        Ok(received)
    }
}
