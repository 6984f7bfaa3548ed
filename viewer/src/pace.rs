//! At most one frame is under way: a GPU that is slower than the page's frames would else fall behind, and
//! answer late to every touch.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};

/// Frames that take longer than this are not spent on averaging a still picture.
const SLOW_MS: u32 = 60;

/// Whether the GPU is at work on a frame, and how long the last one took.
#[derive(Clone, Debug, Default)]
pub struct Pace(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    busy: AtomicBool,
    last_ms: AtomicU32,
}

impl Pace {
    /// True from the end of a frame's commands to the end of the GPU's work on them.
    pub fn is_busy(&self) -> bool {
        self.0.busy.load(Ordering::Relaxed)
    }

    /// True where the last frame took so long that averaging would stand in the way.
    pub fn is_slow(&self) -> bool {
        self.0.last_ms.load(Ordering::Relaxed) > SLOW_MS
    }

    /// A frame has been submitted. Call what it gives when the GPU has done it, with the milliseconds since.
    pub fn begin(&self) -> impl FnOnce(f64) + Send + 'static {
        let shared = self.0.clone();
        shared.busy.store(true, Ordering::Relaxed);
        move |milliseconds| {
            shared.last_ms.store(milliseconds.max(0.0) as u32, Ordering::Relaxed);
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
        let done = pace.begin();
        assert!(pace.is_busy());
        done(500.0);
        assert!(!pace.is_busy() && pace.is_slow());
        pace.begin()(8.0);
        assert!(!pace.is_busy() && !pace.is_slow());
    }
}
