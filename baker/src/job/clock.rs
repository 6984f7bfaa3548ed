//! Time since the first call, on the wall clock and of the processor. Zero where the platform has no clock
//! (wasm32-unknown-unknown).

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

/// Returns the wall-clock time: none here.
#[cfg(target_arch = "wasm32")]
pub fn wall() -> Duration {
    Duration::ZERO
}

/// Returns the processor time: none here.
#[cfg(target_arch = "wasm32")]
pub fn processor() -> Duration {
    Duration::ZERO
}
