//! Sizes of baked files: the download of a page.

use rebounce::bake::{BakeSettings, Preset, bake};
use std::path::Path;

/// Bytes of a file, and number of its functions.
fn baked(spec: &str, preset: Preset) -> (usize, usize) {
    let scene = rebounce::io::load(spec).unwrap();
    let (file, _) = bake(&scene, &BakeSettings::new(preset), &()).unwrap();
    (file.to_bytes().unwrap().len(), file.points.len())
}

#[test]
fn a_function_with_its_links_takes_at_most_seventy_bytes() {
    // A room without textures: the file is light transport, except for a few thousand bytes.
    let (bytes, functions) = baked("builtin:cornell-box", Preset::Draft);
    let each = bytes as f64 / functions as f64;
    assert!((20.0..=70.0).contains(&each), "{each:.1} bytes for each of {functions} functions");
}

#[test]
#[ignore = "bakes a large scene for minutes: cargo test --test all -- --ignored"]
fn a_hall_with_its_textures_is_loaded_in_twelve_megabytes() {
    // Without the scene file, only the test above applies.
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/scenes");
    let hall = folder.join("sponza-dabrovic/sponza-dabrovic.glb");
    if let Some(hall) = hall.to_str().filter(|_| hall.exists()) {
        let (bytes, _) = baked(hall, Preset::Standard);
        assert!(bytes <= 12_000_000, "{bytes} bytes");
    }
}
