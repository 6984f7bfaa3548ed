//! A whole .rbn file: refused, or read and written again to the same scene.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rebounce_shared::rbn::Scene;

fuzz_target!(|bytes: &[u8]| {
    let Ok(scene) = Scene::from_bytes(bytes) else { return };
    let again = scene.to_bytes().expect("what was read can be written");
    assert!(Scene::from_bytes(&again).expect("what was written can be read") == scene);
});
