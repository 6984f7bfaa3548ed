//! Work that takes long tells how far it is, and asks whether to go on.

/// Somebody asked for the work to end before it was done.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("stopped before it was done")]
pub struct Stopped;

/// Follows work that takes long. All threads call it, once for each piece of some milliseconds.
pub trait Watch: Sync {
    /// So many units more are done, of those that the work counts in; 0 only asks whether to go on.
    ///
    /// # Errors
    /// [`Stopped`] when the work shall end now.
    fn step(&self, units: u64) -> Result<(), Stopped>;

    /// So many units more were done in an earlier run.
    ///
    /// # Errors
    /// [`Stopped`] when the work shall end now.
    fn skip(&self, units: u64) -> Result<(), Stopped> {
        self.step(units)
    }

    /// So many units there are in all, as is known only now that the work has begun; told before the first is done.
    fn expect(&self, _units: u64) {}
}

/// Asks whether to go on, and counts nothing: for work that is a small part of another.
pub struct Uncounted<'a>(pub &'a dyn Watch);

impl Watch for Uncounted<'_> {
    fn step(&self, _units: u64) -> Result<(), Stopped> {
        self.0.step(0)
    }
}

/// Nobody watches: the work goes on to its end.
impl Watch for () {
    fn step(&self, _units: u64) -> Result<(), Stopped> {
        Ok(())
    }
}
