//! Ctrl-C and SIGTERM: the bake is asked to end, and ended if it does not.

use signal_hook::consts::{SIGINT, SIGTERM};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

/// The bake may take so long to end by itself.
const PATIENCE: Duration = Duration::from_millis(600);
const LOOK_EVERY: Duration = Duration::from_millis(20);
/// Within a second it is over, where the machine does nothing else.
const _: () = assert!(PATIENCE.as_millis() + 2 * LOOK_EVERY.as_millis() < 1000);

/// Which signal asked for the end.
#[derive(Clone)]
pub struct Stop {
    signal: Arc<AtomicUsize>,
    /// The process must not be ended now.
    is_held: Arc<AtomicBool>,
}

impl Stop {
    /// From now on signals no longer end the process at once. `last_words` are said before it is ended.
    ///
    /// # Errors
    /// What the system says.
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

    /// Whether the end was asked for.
    pub fn is_asked(&self) -> bool {
        self.signal.load(Ordering::Relaxed) != 0
    }

    /// What shells expect of a program that a signal ended: 130 after Ctrl-C, 143 after SIGTERM.
    pub fn exit_code(&self) -> u8 {
        (128 + self.signal.load(Ordering::Relaxed)).min(255) as u8
    }

    /// The end must wait: a file is being put in its place.
    pub fn hold(&self) {
        self.is_held.store(true, Ordering::Release);
    }

    /// It need wait no longer.
    pub fn release(&self) {
        self.is_held.store(false, Ordering::Release);
    }
}

/// Lets signals end the process at once, with the codes that shells expect, even where it was started with them ignored:
/// what a script starts in the background is.
///
/// # Errors
/// What the system says.
pub fn end_at_once() -> io::Result<()> {
    for signal in [SIGINT, SIGTERM] {
        signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, Arc::new(true.into()))?;
    }
    Ok(())
}
