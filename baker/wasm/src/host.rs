//! What JavaScript does for a worker.

use js_sys::Uint8Array;
use rebounce::bake::{BakeSettings, budget};
use rebounce::job::clock;
use rebounce::scene::Scene;
use std::cell::RefCell;
use std::time::Duration;
use wasm_bindgen::prelude::*;

/// Most bytes of memory of a worker, by the estimate.
const MOST_MEMORY: u64 = 2_000_000_000;

#[wasm_bindgen]
extern "C" {
    /// What the worker's JavaScript does for the bake: `Host` of `web/src/bake/host.ts`.
    pub type Host;

    /// Milliseconds of a clock.
    #[wasm_bindgen(method)]
    fn now(this: &Host) -> f64;

    /// Reports a stage, the share of the bake's time that has passed, and the seconds left.
    #[wasm_bindgen(method)]
    pub fn progress(this: &Host, stage: &str, ratio: f64, seconds_left: f64);

    /// Hands over a preview: a .rbn file.
    #[wasm_bindgen(method)]
    pub fn preview(this: &Host, file: Uint8Array);

    /// Tells what of the scene is left out or changed.
    #[wasm_bindgen(method)]
    pub fn warn(this: &Host, sentence: &str);

    /// Tells why the next trap happens.
    #[wasm_bindgen(method)]
    fn panicked(this: &Host, why: &str);

    /// Sends to the first worker and to all workers; returns what was sent here: two arrays of `Uint8Array`s, by worker.
    #[wasm_bindgen(method, catch)]
    pub async fn exchange(this: &Host, to_first: Uint8Array, to_all: Uint8Array) -> Result<JsValue, JsValue>;
}

thread_local! {
    /// What this worker reports to: an observer is `Sync`, JavaScript's objects are not.
    static HOST: RefCell<Option<Host>> = const { RefCell::new(None) };
}

/// Sets what this worker reports to; panics and the clock go there, too.
pub fn set_host(host: &Host) {
    let object: &JsValue = host.as_ref();
    HOST.with_borrow_mut(|place| *place = Some(object.clone().unchecked_into()));
    std::panic::set_hook(Box::new(|info| {
        with_host(|host| host.panicked(&info.to_string()));
    }));
    clock::set(|| with_host(|host| milliseconds(host.now())).unwrap_or_default());
}

/// Calls `tell` with what this worker reports to; `None` before that is set.
pub fn with_host<T>(tell: impl FnOnce(&Host) -> T) -> Option<T> {
    HOST.with_borrow(|host| host.as_ref().map(tell))
}

/// Returns a span of time.
pub fn milliseconds(count: f64) -> Duration {
    Duration::from_secs_f64((count * 1e-3).max(0.0))
}

/// Refuses a scene that needs more memory than a worker has. `place`: what has that limit.
///
/// # Errors
/// A sentence.
pub fn check_memory(scene: &Scene, settings: &BakeSettings, path: &str, place: &str) -> Result<(), String> {
    let needed = budget::memory(scene, settings);
    if needed <= MOST_MEMORY {
        return Ok(());
    }
    Err(format!(
        "{path} needs about {:.1} GB of memory in each worker, more than the {:.0} GB that {place} may use: {}; simplify that, choose a coarser preset, or bake with the command rebounce",
        needed as f64 * 1e-9,
        MOST_MEMORY as f64 * 1e-9,
        budget::largest_in_memory(scene)
    ))
}
