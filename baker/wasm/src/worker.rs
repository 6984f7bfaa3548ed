//! A bake of a page in one worker.

use super::host::{Host, check_memory, set_host};
use super::observer::PageObserver;
use super::options::PageOptions;
use super::workers::Workers;
use js_sys::Uint8Array;
use rebounce::bake::{BakeError, Baker};
use rebounce::io::files::Memory;
use rebounce::io::load_from;
use std::path::Path;
use wasm_bindgen::prelude::*;

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
    set_host(&host);
    let options = PageOptions::read(&options).map_err(|error| JsError::new(&error))?;
    let settings = options.settings().map_err(|error| JsError::new(&error))?;
    let scene = load_from(&files.files, Path::new(&path), &options.load_options())?;
    drop(files);
    scene.left_out.iter().for_each(|problem| host.warn(&format!("left out: {problem}")));
    scene.notes.iter().for_each(|note| host.warn(note));
    check_memory(&scene, &settings, &path, "pages").map_err(|error| JsError::new(&error))?;
    let workers = Workers { host: &host, rank, size };
    let observer = PageObserver { wants_previews: options.previews };
    let baked = Baker::new(&settings).observer(&observer).communicator(&workers).bake_async(&scene).await?;
    let Some((baked, report)) = baked else { return Ok(None) };
    drop(scene);
    let bytes = baked.to_bytes().map_err(BakeError::from)?;
    Ok(Some(BakedFile { bytes, report: report.to_string() }))
}
