//! A .gltf or .glb file: a scene with valid indices and finite numbers, or an error. The mutator keeps the container
//! valid.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use rebounce_fuzz::bounded;
use rebounce_fuzz::glb::mutate;

/// Memory limit of decoded pictures, bytes: the sizes in the pictures' headers are trusted up to 2^26 texels per
/// file.
const PICTURES: usize = 600 << 20;

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, size, max_size, seed)
});

fuzz_target!(|bytes: &[u8]| {
    let has_pictures = bytes.windows(8).any(|w| w == b"\"images\"");
    let more = if has_pictures { PICTURES } else { 0 };
    let Ok(scene) = bounded(bytes.len(), more, || rebounce::io::from_bytes("fuzz.glb", bytes)) else { return };
    assert!(scene.triangles.as_flattened().iter().all(|&i| (i as usize) < scene.positions.len()));
    assert!(scene.positions.iter().all(|p| p.is_finite()));
    assert!(scene.triangle_material.iter().all(|&m| (m as usize) < scene.materials.len()));
    assert!(scene.lights.iter().all(|light| light.is_usable()));
    assert!(scene.cameras.iter().all(|camera| camera.is_usable()));
});
