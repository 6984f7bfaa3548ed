//! Unpacked contents of a .rbn file: with arbitrary numbers, the file is rejected or satisfies the invariants of the
//! viewer. The input is switches and the bytes of the sections with length prefixes.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use rebounce_fuzz::bounded;
use rebounce_fuzz::contents::{Contents, keeps_promises, mutate};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::container;

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, size, max_size, seed)
});

fuzz_target!(|bytes: &[u8]| {
    let Some(contents) = Contents::from_bytes(bytes) else { return };
    let sections = contents.packed();
    let sections: Vec<_> = sections.iter().map(|(name, bytes)| (*name, bytes.as_slice())).collect();
    let file = container::write(container::VERSION, &sections);
    let Ok(scene) = bounded(file.len(), 0, || BakedScene::from_bytes(&file)) else { return };
    keeps_promises(&scene);
});
