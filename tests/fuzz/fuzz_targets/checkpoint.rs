//! Checkpoint of a bake: arbitrary records are rejected or resumed.
#![no_main]

use libfuzzer_sys::{fuzz_mutator, fuzz_target};
use rebounce::bake::{BakeSettings, Checkpoint, Identity, Preset};
use rebounce_fuzz::bounded;
use rebounce_fuzz::partial::mutate;
use std::path::PathBuf;
use std::sync::LazyLock;

/// Identity of the seeds' bake.
static IDENTITY: LazyLock<Identity> = LazyLock::new(|| {
    let scene = rebounce::io::load("builtin:cornell-box").expect("it is built in");
    Identity::new(&scene, &BakeSettings::new(Preset::Draft))
});
/// Path of the input file: in memory if the system has such a folder, since a disk is slow.
static FILE: LazyLock<PathBuf> = LazyLock::new(|| {
    let memory = PathBuf::from("/dev/shm");
    let folder = if memory.is_dir() { memory } else { std::env::temp_dir() };
    folder.join(format!("rebounce-fuzz-{}.partial", std::process::id()))
});

fuzz_mutator!(|data: &mut [u8], size: usize, max_size: usize, seed: u32| {
    mutate(data, size, max_size, seed)
});

fuzz_target!(|bytes: &[u8]| {
    std::fs::write(&*FILE, bytes).expect("a folder for temporary files");
    match bounded(bytes.len(), 0, || Checkpoint::resume(&FILE, &IDENTITY)) {
        Ok(checkpoint) => assert!(checkpoint.flush().is_ok()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
