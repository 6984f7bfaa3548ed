//! Ctrl-C and SIGTERM: a request to end the bake, then a forced exit.

use signal_hook::consts::{SIGINT, SIGTERM};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

/// Time for the bake to end by itself, before the forced exit.
const PATIENCE: Duration = Duration::from_millis(600);
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// On an idle machine, the process ends within a second.
const _: () = assert!(PATIENCE.as_millis() + 2 * LOOK_EVERY.as_millis() < 1000);

/// Request to end, by signal.
#[derive(Clone)]
pub struct Stop {
    signal: Arc<AtomicUsize>,
    /// Delays the forced exit.
    is_held: Arc<AtomicBool>,
}

impl Stop {
    /// Installs handlers: signals no longer end the process at once. Calls `last_words` before the forced exit.
    ///
    /// # Errors
    /// The operating system's error.
    pub fn install(last_words: impl Fn() + Send + 'static) -> io::Result<Self> {
        let stop = Self { signal: Arc::default(), is_held: Arc::default() };
        for signal in [SIGINT, SIGTERM] {
            signal_hook::flag::register_usize(signal, stop.signal.clone(), signal as usize)?;
        }
        let watched = stop.clone();
        std::thread::spawn(move || {
            while !watched.is_asked() {
                std::thread::sleep(LOOK_EVERY);
            }
            std::thread::sleep(PATIENCE);
            while watched.is_held.load(Ordering::Acquire) {
                std::thread::sleep(LOOK_EVERY);
            }
            last_words();
            std::process::exit(i32::from(watched.exit_code()));
        });
        Ok(stop)
    }

    /// Whether a signal has requested the end.
    pub fn is_asked(&self) -> bool {
        self.signal.load(Ordering::Relaxed) != 0
    }

    /// Exit code after a signal, as shells expect: 130 after Ctrl-C, 143 after SIGTERM.
    pub fn exit_code(&self) -> u8 {
        (128 + self.signal.load(Ordering::Relaxed)).min(255) as u8
    }

    /// Delays the forced exit, while a file is moved into place.
    pub fn hold(&self) {
        self.is_held.store(true, Ordering::Release);
    }

    /// Permits the forced exit again.
    pub fn release(&self) {
        self.is_held.store(false, Ordering::Release);
    }
}

/// Lets signals end the process at once, with the exit codes that shells expect, even if the process was started with
/// signals ignored, as background processes of a script are.
///
/// # Errors
/// The operating system's error.
pub fn end_at_once() -> io::Result<()> {
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, Arc::new(true.into()))?;
    }
    Ok(())
}
