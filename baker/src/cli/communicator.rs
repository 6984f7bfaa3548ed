//! The processes that bake together: those that a launcher of MPI programs has started, or this one alone.

use anyhow::Result;
use rebounce::communicator::Communicator;
use std::process::ExitCode;

/// Runs `work` in this process's team. If it fails here, or is stopped, all processes are ended: the others would wait
/// for this one.
#[cfg(feature = "mpi")]
pub fn with_team(work: impl FnOnce(&dyn Communicator) -> Result<u8>) -> Result<ExitCode> {
    use crate::cli::plain::plain;
    use anyhow::Context;
    use rebounce::communicator::mpi::Mpi;
    use std::time::Duration;

    /// So long the first process has to say why it ends before another one ends all.
    const PATIENCE: Duration = Duration::from_secs(2);

    if !Mpi::is_launched() {
        return work(&()).map(ExitCode::from);
    }
    let team = Mpi::join().context("joining the other processes")?;
    let (rank, size) = (team.rank(), team.size());
    let done = work(&team);
    if size == 1 {
        return done.map(ExitCode::from);
    }
    if rank != 0 && !matches!(done, Ok(0)) {
        std::thread::sleep(PATIENCE);
    }
    match done {
        Ok(0) => Ok(ExitCode::SUCCESS),
        Ok(code) => team.abort(code),
        Err(error) => {
            eprintln!("rebounce: process {rank} of {size}: {}", plain(&crate::sentence(&error)));
            team.abort(1)
        }
    }
}

/// Runs `work` in this process alone.
#[cfg(not(feature = "mpi"))]
pub fn with_team(work: impl FnOnce(&dyn Communicator) -> Result<u8>) -> Result<ExitCode> {
    work(&()).map(ExitCode::from)
}
