//! At most one frame is under way: a GPU that is slower than the page's frames would else fall behind, and
//! answer late to every touch.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Where a picture for the average takes longer than this, there are no more.
const SLOW_MS: u32 = 60;
/// After a frame that took as long as this there is not even a first.
const TOO_SLOW_MS: u32 = 600;
/// Where a picture from a new view takes longer than this, it is sketched while the view changes.
const VIEW_MS: u32 = 150;

/// Whether the GPU is at work on a frame, and how long the last one took.
#[derive(Clone, Debug, Default)]
pub struct Pace(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    busy: AtomicBool,
    last_ms: AtomicU32,
    /// Of the last picture for an average; 0 since a frame of another kind.
    average_ms: AtomicU32,
    /// Of the last whole picture from a new view.
    view_ms: AtomicU32,
}

/// What a frame does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// One more picture for the average.
    Average,
    /// A whole picture from a new view.
    View,
    /// Anything else.
    Other,
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

    /// True where a picture from a new view takes too long to move by.
    pub fn is_slow_to_move(&self) -> bool {
        self.0.view_ms.load(Ordering::Relaxed) > VIEW_MS
    }

    /// For a device that is known to be slow before it has drawn anything.
    pub fn expect_slow(&self) {
        self.0.view_ms.store(u32::MAX, Ordering::Relaxed);
    }

    /// A frame has been submitted. Call what it gives when the GPU has done it, with the milliseconds since.
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
        // A long first frame (pipelines, uploads) says little about the next.
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
