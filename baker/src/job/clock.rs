//! Time on the wall clock and of the processor, since any moment. On wasm32-unknown-unknown, which has no clock, that of
//! the clock that the program sets; without one, zero.

use std::time::Duration;

/// Returns the wall-clock time.
#[cfg(not(target_arch = "wasm32"))]
pub fn wall() -> Duration {
    use std::sync::OnceLock;
    use std::time::Instant;
    static START: OnceLock<Instant> = OnceLock::new();
    START.get_or_init(Instant::now).elapsed()
}

/// Returns the processor time of all threads of this process.
#[cfg(not(target_arch = "wasm32"))]
pub fn processor() -> Duration {
    use cpu_time::ProcessTime;
    use std::sync::OnceLock;
    static START: OnceLock<ProcessTime> = OnceLock::new();
    START.get_or_init(ProcessTime::now).elapsed()
}

/// Clock of this program: time since any moment.
#[cfg(target_arch = "wasm32")]
static CLOCK: std::sync::OnceLock<fn() -> Duration> = std::sync::OnceLock::new();

/// Clock of the processor time of all threads.
#[cfg(target_arch = "wasm32")]
static PROCESSOR: std::sync::OnceLock<fn() -> Duration> = std::sync::OnceLock::new();

/// Sets the clock, which the platform itself lacks. Only the first call has an effect.
#[cfg(target_arch = "wasm32")]
pub fn set(clock: fn() -> Duration) {
    let _ = CLOCK.set(clock);
}

/// Sets the clock of the processor time of all threads. Only the first call has an effect.
#[cfg(target_arch = "wasm32")]
pub fn set_processor(clock: fn() -> Duration) {
    let _ = PROCESSOR.set(clock);
}

/// Returns the wall-clock time.
#[cfg(target_arch = "wasm32")]
pub fn wall() -> Duration {
    CLOCK.get().map_or(Duration::ZERO, |clock| clock())
}

/// Returns the processor time: without a clock of it that of one thread, the wall-clock time.
#[cfg(target_arch = "wasm32")]
pub fn processor() -> Duration {
    PROCESSOR.get().map_or_else(wall, |clock| clock())
}
