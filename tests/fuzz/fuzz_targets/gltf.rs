//! A .gltf or .glb file: a scene whose indices fit, or an error.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rebounce::scene;

fuzz_target!(|bytes: &[u8]| {
    let Ok(scene) = scene::from_bytes("fuzz.glb", bytes) else { return };
    assert!(scene.triangles.as_flattened().iter().all(|&i| (i as usize) < scene.positions.len()));
    assert!(scene.positions.iter().all(|p| p.is_finite()));
    assert!(scene.triangle_material.iter().all(|&m| (m as usize) < scene.materials.len()));
});
