//! `cargo xtask bench-radiosity`: radiosity of things that move, in the 2011 paper's ways and ours, and reconstruction groups.

use crate::{install, report};
use anyhow::Result;

/// Scenes when none is named.
const SCENES: [&str; 2] = ["builtin:cornell-box", "builtin:apartment"];

/// Measures and writes docs/reports/radiosity.md. `args` go to the example: `--functions N` and scenes.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    install::ensure(&install::BROWSER)?;
    let names_scene =
        args.iter().any(|arg| arg.contains(':') || arg.ends_with(".glb") || arg.ends_with(".gltf"));
    let scenes = if names_scene { &[][..] } else { &SCENES };
    let all: Vec<String> =
        args.iter().cloned().chain(scenes.iter().map(|scene| (*scene).to_owned())).collect();
    let line = ["cargo xtask bench-radiosity"].into_iter().chain(args.iter().map(String::as_str));
    let line: Vec<&str> = line.collect();
    report::of_example("radiosity", "Radiosity and groups", &all, &line.join(" "))
}
