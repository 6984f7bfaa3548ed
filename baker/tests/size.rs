//! Sizes of baked files: the download of a page.

use rebounce::bake::{BakeSettings, Preset, bake};
use std::path::Path;

/// Bytes of a file, and number of its functions.
fn baked(spec: &str, preset: Preset) -> (usize, usize) {
    let scene = rebounce::io::load(spec).unwrap();
    let (file, _) = bake(&scene, &BakeSettings::new(preset), &()).unwrap();
    (file.to_bytes().unwrap().len(), file.points.len())
}

/// Looks at a room without textures: the file is light transport, except for a few thousand bytes.
fn takes_at_most_seventy_bytes_a_function(spec: &str) {
    let (bytes, functions) = baked(spec, Preset::Draft);
    let each = bytes as f64 / functions as f64;
    assert!((20.0..=70.0).contains(&each), "{spec}: {each:.1} bytes for each of {functions} functions");
}

#[test]
fn a_function_with_its_links_takes_at_most_seventy_bytes() {
    takes_at_most_seventy_bytes_a_function("builtin:cornell-box");
}

#[test]
#[ignore = "takes much processor time: docs/dev/testing.md"]
fn a_function_of_many_rooms_takes_at_most_seventy_bytes() {
    takes_at_most_seventy_bytes_a_function("builtin:apartment");
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
