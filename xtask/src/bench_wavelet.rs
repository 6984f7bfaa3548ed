//! `cargo xtask bench-wavelet`: wavelet radiosity on exact surfaces and on triangles, in the columns of Alonso et al. 2001.

use crate::report;
use anyhow::Result;

/// Generated scenes, unless others are named.
const SCENES: &str = "teapot,tori";

/// Measures and writes docs/reports/wavelet.md. `args`: `--quick` for noisier errors, and names of generated scenes.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    let (options, names): (Vec<&String>, Vec<&String>) = args.iter().partition(|arg| arg.starts_with("--"));
    let names: Vec<&str> = names.into_iter().map(String::as_str).collect();
    let names = if names.is_empty() { SCENES.to_owned() } else { names.join(",") };
    let mut passed: Vec<String> = options.into_iter().cloned().collect();
    passed.extend(["--wavelets".to_owned(), names]);
    let line: Vec<&str> =
        ["cargo xtask bench-wavelet"].into_iter().chain(args.iter().map(String::as_str)).collect();
    let figures = report::printed_by("rebounce-tests", "cad", &passed)?;
    println!("{figures}");
    report::write("wavelet", "Wavelet radiosity", &line.join(" "), &figures)
}
