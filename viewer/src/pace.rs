//! At most one frame is under way: a GPU that is slower than the page's frames would else fall behind, and
//! answer late to every touch.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Where a picture for the average takes longer than this, there are no more.
const SLOW_MS: u32 = 60;
/// After a frame that took as long as this there is not even a first.
const TOO_SLOW_MS: u32 = 600;

/// Whether the GPU is at work on a frame, and how long the last one took.
#[derive(Clone, Debug, Default)]
pub struct Pace(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    busy: AtomicBool,
    last_ms: AtomicU32,
    /// Of the last picture for an average; 0 since a frame of another kind.
    average_ms: AtomicU32,
}

impl Pace {
    /// True from the end of a frame's commands to the end of the GPU's work on them.
    pub fn is_busy(&self) -> bool {
        self.0.busy.load(Ordering::Relaxed)
    }

    /// True where averaging a still picture would stand in the way of the next touch.
    pub fn is_slow(&self) -> bool {
        self.0.average_ms.load(Ordering::Relaxed) > SLOW_MS
            || self.0.last_ms.load(Ordering::Relaxed) > TOO_SLOW_MS
    }

    /// A frame has been submitted, one more picture for the average or another. Call what it gives when the GPU
    /// has done it, with the milliseconds since.
    pub fn begin(&self, averages: bool) -> impl FnOnce(f64) + Send + 'static {
        let shared = self.0.clone();
        shared.busy.store(true, Ordering::Relaxed);
        move |milliseconds| {
            let milliseconds = milliseconds.max(0.0) as u32;
            shared.last_ms.store(milliseconds, Ordering::Relaxed);
            shared.average_ms.store(if averages { milliseconds } else { 0 }, Ordering::Relaxed);
            shared.busy.store(false, Ordering::Relaxed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_frame_at_a_time_and_slow_ones_are_remembered() {
        let pace = Pace::default();
        assert!(!pace.is_busy() && !pace.is_slow());
        let done = pace.begin(false);
        assert!(pace.is_busy());
        // A long first frame (pipelines, uploads) says little about the next.
        done(200.0);
        assert!(!pace.is_busy() && !pace.is_slow());
        pace.begin(true)(100.0);
        assert!(pace.is_slow());
        pace.begin(false)(100.0);
        assert!(!pace.is_slow());
        pace.begin(false)(5000.0);
        assert!(pace.is_slow());
    }
}
