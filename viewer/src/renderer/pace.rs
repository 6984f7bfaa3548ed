//! Limits the GPU to a single frame in flight: without the limit, a GPU slower than the page's frame rate would
//! fall behind and respond late to input.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Averaging stops when a picture for the average takes longer.
const SLOW_MS: u32 = 60;
/// After a frame that took longer, averaging does not begin.
const TOO_SLOW_MS: u32 = 600;
/// When a full picture from a new view takes longer, sketches are drawn while the view changes.
const VIEW_MS: u32 = 150;

/// Whether the GPU works on a frame, and the time of the last frame.
#[derive(Clone, Debug, Default)]
pub struct Pace(Arc<PaceState>);

#[derive(Debug, Default)]
struct PaceState {
    busy: AtomicBool,
    last_ms: AtomicU32,
    /// Time of the last picture for an average; 0 after a frame of another kind.
    average_ms: AtomicU32,
    /// Time of the last full picture from a new view.
    view_ms: AtomicU32,
}

/// Kind of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// A further picture for the average.
    Average,
    /// A full picture from a new view.
    View,
    /// Any other frame.
    Other,
}

impl Pace {
    /// True from the end of a frame's commands to the end of the GPU's work on them.
    pub fn is_busy(&self) -> bool {
        self.0.busy.load(Ordering::Relaxed)
    }

    /// True if averaging a still picture would delay the response to the next input.
    pub fn is_slow(&self) -> bool {
        self.0.average_ms.load(Ordering::Relaxed) > SLOW_MS
            || self.0.last_ms.load(Ordering::Relaxed) > TOO_SLOW_MS
    }

    /// True if a picture from a new view takes too long for interactive movement.
    pub fn is_slow_to_move(&self) -> bool {
        self.0.view_ms.load(Ordering::Relaxed) > VIEW_MS
    }

    /// Marks the device as slow before the first frame.
    pub fn expect_slow(&self) {
        self.0.view_ms.store(u32::MAX, Ordering::Relaxed);
    }

    /// Marks a frame as submitted. Call the returned closure when the GPU has finished the frame, with the
    /// milliseconds since.
    pub fn begin(&self, work: Work) -> impl FnOnce(f64) + Send + 'static {
        let shared = self.0.clone();
        shared.busy.store(true, Ordering::Relaxed);
        move |milliseconds| {
            let milliseconds = milliseconds.max(0.0) as u32;
            shared.last_ms.store(milliseconds, Ordering::Relaxed);
            let average = if work == Work::Average { milliseconds } else { 0 };
            shared.average_ms.store(average, Ordering::Relaxed);
            if work == Work::View {
                shared.view_ms.store(milliseconds, Ordering::Relaxed);
            }
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
        let done = pace.begin(Work::Other);
        assert!(pace.is_busy());
        // A long first frame (pipelines, uploads) does not predict the next frame.
        done(200.0);
        assert!(!pace.is_busy() && !pace.is_slow());
        pace.begin(Work::Average)(100.0);
        assert!(pace.is_slow());
        pace.begin(Work::Other)(100.0);
        assert!(!pace.is_slow());
        pace.begin(Work::Other)(5000.0);
        assert!(pace.is_slow());
    }

    #[test]
    fn whole_views_tell_whether_to_sketch() {
        let pace = Pace::default();
        assert!(!pace.is_slow_to_move());
        pace.begin(Work::View)(400.0);
        assert!(pace.is_slow_to_move());
        // A quick sketch changes nothing; a quick whole view does.
        pace.begin(Work::Other)(20.0);
        assert!(pace.is_slow_to_move());
        pace.begin(Work::View)(20.0);
        assert!(!pace.is_slow_to_move());
    }
}
