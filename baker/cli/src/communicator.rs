//! Communicator of a bake: the processes started by an MPI launcher, or a single process.

use anyhow::Result;
use rebounce::job::communicator::Communicator;
use std::process::ExitCode;

/// Runs `work` with the communicator of this process. If `work` fails or is stopped, ends all processes: the remaining
/// processes would wait for this process.
#[cfg(feature = "mpi")]
pub fn with_communicator(work: impl FnOnce(&dyn Communicator) -> Result<u8>) -> Result<ExitCode> {
    use anyhow::Context;
    use rebounce::job::communicator::mpi::Mpi;
    use rebounce_args::escape::escape_controls;
    use std::time::Duration;

    /// Time for the first process to print the reason before a different process ends all processes.
    const PATIENCE: Duration = Duration::from_secs(2);

    if !Mpi::is_launched() {
        return work(&()).map(ExitCode::from);
    }
    let communicator = Mpi::join().context("joining the other processes")?;
    let (rank, size) = (communicator.rank(), communicator.size());
    let done = work(&communicator);
    if size == 1 {
        return done.map(ExitCode::from);
    }
    if rank != 0 && !matches!(done, Ok(0)) {
        std::thread::sleep(PATIENCE);
    }
    match done {
        Ok(0) => Ok(ExitCode::SUCCESS),
        Ok(code) => communicator.abort(code),
        Err(error) => {
            eprintln!("rebounce: process {rank} of {size}: {}", escape_controls(&crate::sentence(&error)));
            communicator.abort(1)
        }
    }
}

/// Runs `work` in a single process.
#[cfg(not(feature = "mpi"))]
pub fn with_communicator(work: impl FnOnce(&dyn Communicator) -> Result<u8>) -> Result<ExitCode> {
    work(&()).map(ExitCode::from)
}
