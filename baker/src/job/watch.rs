//! Progress reports and cancellation of long computations.

/// A computation was cancelled before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped before it was done")]
pub struct Stopped;

/// Observer of a long computation. Called from all threads, once per work item of a few
/// milliseconds.
pub trait Watch: Sync {
    /// Reports `units` further finished units of work; 0 only checks for cancellation.
    ///
    /// # Errors
    /// [`Stopped`] on cancellation.
    fn step(&self, units: u64) -> Result<(), Stopped>;

    /// Reports `units` further units as finished in an earlier run.
    ///
    /// # Errors
    /// [`Stopped`] on cancellation.
    fn skip(&self, units: u64) -> Result<(), Stopped> {
        self.step(units)
    }

    /// Announces the total number of units, known only after the start of the work; called before
    /// the first [`Self::step`].
    fn expect(&self, _units: u64) {}
}

/// Forwards cancellation without counting: for a small part of a larger computation.
pub struct Uncounted<'a>(pub &'a dyn Watch);

impl Watch for Uncounted<'_> {
    fn step(&self, _units: u64) -> Result<(), Stopped> {
        self.0.step(0)
    }
}

/// No observer: the work runs to its end.
impl Watch for () {
    fn step(&self, _units: u64) -> Result<(), Stopped> {
        Ok(())
    }
}
