//! A bake in one worker.

use super::observer::{PageObserver, set_host, with_host};
use super::options::PageOptions;
use super::workers::Workers;
use js_sys::Uint8Array;
use rebounce::bake::{BakeError, BakeSettings, Baker, budget};
use rebounce::io::files::Memory;
use rebounce::io::{LoadOptions, load_from};
use rebounce::job::clock;
use rebounce::scene::Scene;
use std::path::Path;
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
    fn warn(this: &Host, sentence: &str);

    /// Tells why the next trap happens.
    #[wasm_bindgen(method)]
    fn panicked(this: &Host, why: &str);

    /// Sends to the first worker and to all workers; returns what was sent here: two arrays of `Uint8Array`s, by worker.
    #[wasm_bindgen(method, catch)]
    pub async fn exchange(this: &Host, to_first: Uint8Array, to_all: Uint8Array) -> Result<JsValue, JsValue>;
}

/// Result of a bake.
#[wasm_bindgen]
pub struct BakedFile {
    bytes: Vec<u8>,
    report: String,
}

#[wasm_bindgen]
impl BakedFile {
    /// The .rbn file.
    #[wasm_bindgen(getter)]
    pub fn bytes(&self) -> Uint8Array {
        Uint8Array::from(&self.bytes[..])
    }

    /// The figures of the bake, as lines of text.
    #[wasm_bindgen(getter)]
    pub fn report(&self) -> String {
        self.report.clone()
    }
}

/// The files of a scene, by path: the scene's file, and those that it refers to.
#[wasm_bindgen]
#[derive(Default)]
pub struct SceneFiles {
    files: Memory,
}

#[wasm_bindgen]
impl SceneFiles {
    /// Creates an empty set.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file.
    pub fn insert(&mut self, path: &str, bytes: Vec<u8>) {
        self.files.insert(path, bytes);
    }
}

/// Refuses a scene that needs more memory than a worker has.
fn check_memory(scene: &Scene, settings: &BakeSettings, path: &str) -> Result<(), String> {
    let needed = budget::memory(scene, settings);
    if needed <= MOST_MEMORY {
        return Ok(());
    }
    Err(format!(
        "{path} needs about {:.1} GB of memory in each worker, more than the {:.0} GB that pages may use: {}; simplify that, choose a coarser preset, or bake with the command rebounce",
        needed as f64 * 1e-9,
        MOST_MEMORY as f64 * 1e-9,
        budget::largest_in_memory(scene)
    ))
}

/// Bakes the scene in the file at `path` as worker `rank` of `size`. Returns the file on worker 0, nothing on the others.
///
/// # Errors
/// A sentence, as an `Error`.
#[wasm_bindgen]
pub async fn bake(
    host: Host,
    files: SceneFiles,
    path: String,
    options: String,
    rank: usize,
    size: usize,
) -> Result<Option<BakedFile>, JsError> {
    let report_to: &JsValue = host.as_ref();
    set_host(report_to.clone().unchecked_into());
    std::panic::set_hook(Box::new(|info| with_host(|host| host.panicked(&info.to_string()))));
    clock::set(|| {
        let mut now = Duration::ZERO;
        with_host(|host| now = Duration::from_secs_f64(host.now() * 1e-3));
        now
    });
    let options = PageOptions::read(&options).map_err(|error| JsError::new(&error))?;
    let settings = options.settings().map_err(|error| JsError::new(&error))?;
    let scene = load_from(&files.files, Path::new(&path), &LoadOptions::default())?;
    drop(files);
    scene.left_out.iter().for_each(|problem| host.warn(&format!("left out: {problem}")));
    scene.notes.iter().for_each(|note| host.warn(note));
    check_memory(&scene, &settings, &path).map_err(|error| JsError::new(&error))?;
    let workers = Workers { host: &host, rank, size };
    let observer = PageObserver { wants_previews: options.previews };
    let baked = Baker::new(&settings).observer(&observer).communicator(&workers).bake_async(&scene).await?;
    let Some((baked, report)) = baked else { return Ok(None) };
    drop(scene);
    let bytes = baked.to_bytes().map_err(BakeError::from)?;
    Ok(Some(BakedFile { bytes, report: report.to_string() }))
}
