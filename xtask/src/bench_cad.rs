//! `cargo xtask bench-cad`: exact surfaces beside triangles: lost hits, rays a second, wavelet radiosity.

use crate::{process, report};
use anyhow::{Context, Result, ensure};
use std::process::Stdio;

/// Measures and writes docs/reports/cad.md. `args` go to the example: `--rays N`, `--quick` and STEP files.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    let mut command = process::cargo();
    command.args(["run", "--release", "--locked", "--package", "rebounce-tests", "--example", "cad", "--"]);
    let output = command.args(args).stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.context("the figures could not be made")?;
    let figures = String::from_utf8_lossy(&output.stdout);
    println!("{figures}");
    ensure!(output.status.success(), "the figures were not finished ({})", output.status);
    // Folders of files are the reader's own.
    let args = args.iter().map(|arg| arg.rsplit('/').next().unwrap_or(arg));
    let command: Vec<&str> = ["cargo xtask bench-cad"].into_iter().chain(args).collect();
    report::write("cad", "Exact surfaces and wavelet radiosity", &command.join(" "), &figures)
}
