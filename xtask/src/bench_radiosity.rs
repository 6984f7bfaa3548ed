//! `cargo xtask bench-radiosity`: radiosity of things that move, in the 2011 paper's ways and ours, and reconstruction groups.

use crate::{install, process, report};
use anyhow::{Context, Result, ensure};
use std::process::Stdio;

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
    let mut command = process::cargo();
    command.args([
        "run",
        "--release",
        "--locked",
        "--package",
        "rebounce-tests",
        "--example",
        "radiosity",
        "--",
    ]);
    command.args(args).args(if names_scene { &[][..] } else { &SCENES });
    let output = command.stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.context("the figures could not be made")?;
    let figures = String::from_utf8_lossy(&output.stdout);
    println!("{figures}");
    ensure!(output.status.success(), "the figures were not finished ({})", output.status);
    let command = ["cargo xtask bench-radiosity"].into_iter().chain(args.iter().map(String::as_str));
    let command: Vec<&str> = command.collect();
    report::write("radiosity", "Radiosity and groups", &command.join(" "), &figures)
}
