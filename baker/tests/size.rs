//! How large files are: what a page has to load.

use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::scene;
use std::path::Path;

/// A file's bytes, and how many functions it has.
fn baked(spec: &str, preset: Preset) -> (usize, usize) {
    let scene = scene::load(spec).unwrap();
    let (file, _) = bake(&scene, &BakeSettings::new(preset), &()).unwrap();
    (file.to_bytes().unwrap().len(), file.points.len())
}

#[test]
fn a_function_with_its_links_takes_at_most_seventy_bytes() {
    // Rooms without textures: all but a few thousand bytes is light transport.
    for spec in ["builtin:apartment", "builtin:cornell-box"] {
        let (bytes, functions) = baked(spec, Preset::Draft);
        let each = bytes as f64 / functions as f64;
        assert!((20.0..=70.0).contains(&each), "{spec}: {each:.1} bytes for each of {functions} functions");
    }
}

#[test]
fn a_hall_with_its_textures_is_loaded_in_twelve_megabytes() {
    // Where this scene is not there, the law above holds alone.
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes");
    let hall = folder.join("sponza-dabrovic/sponza-dabrovic.glb");
    if let Some(hall) = hall.to_str().filter(|_| hall.exists()) {
        let (bytes, _) = baked(hall, Preset::Standard);
        assert!(bytes <= 12_000_000, "{bytes} bytes");
    }
}
