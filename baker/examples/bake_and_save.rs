//! Bakes a scene and saves the file, as a build script (`build.rs`) or an asset pipeline does.
//!
//! `cargo run --release --example bake_and_save [SCENE.glb] [OUTPUT.rbn]`

use rebounce::prelude::*;
use std::error::Error;
use std::path::{Path, PathBuf};

/// Prints each stage once.
struct Stages;

impl Observer for Stages {
    fn progress(&self, progress: &Progress) {
        if progress.done == 0 {
            println!("{} ({:.0} s left)", progress.stage.label(), progress.seconds_left);
        }
    }
}

/// Bakes `scene` into `output`, unless the output is newer than the scene.
pub fn run(scene: &str, output: &Path, settings: &BakeSettings) -> Result<(), Box<dyn Error>> {
    let changed = |path: &Path| std::fs::metadata(path).and_then(|file| file.modified()).ok();
    if changed(output).is_some_and(|baked| changed(Path::new(scene)).is_some_and(|scene| scene <= baked)) {
        println!("{} is up to date", output.display());
        return Ok(());
    }
    // In a build script: println!("cargo::rerun-if-changed={scene}");
    let loaded = load(scene)?;
    for note in loaded.left_out.iter().chain(&loaded.notes) {
        println!("note: {note}");
    }
    let (baked, report) = bake(&loaded, settings, &Stages)?;
    save(output, &baked)?;
    println!("{}: {} functions, {} links", output.display(), report.functions, report.links);
    Ok(())
}

#[allow(dead_code, reason = "tests call `run`")]
fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let scene = arguments.next().unwrap_or_else(|| "builtin:cornell-box".to_owned());
    let output = arguments.next().map_or_else(|| std::env::temp_dir().join("room.rbn"), PathBuf::from);
    run(&scene, &output, &BakeSettings::new(Preset::Draft))
}
