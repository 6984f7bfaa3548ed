//! Entire .rbn file: rejected, or read and written again to an equal scene with the invariants of the viewer. The
//! mutator repairs checksums, so that damage reaches the sections.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use rebounce_fuzz::bounded;
use rebounce_fuzz::rbn::mutate;
use rebounce_shared::baked::BakedScene;

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, size, max_size, seed)
});

fuzz_target!(|bytes: &[u8]| {
    let Ok(scene) = bounded(bytes.len(), 0, || BakedScene::from_bytes(bytes)) else { return };
    let again = scene.to_bytes().expect("what was read can be written");
    let again = BakedScene::from_bytes(&again).expect("what was written can be read");
    // Scenes are compared, not bytes: negative zeros equal zeros, and unused bits of directions may differ.
    assert!(again == scene);
    rebounce_fuzz::contents::keeps_promises(&scene);
});
