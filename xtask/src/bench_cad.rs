//! `cargo xtask bench-cad`: exact surfaces beside triangles: lost hits, rays a second.

use crate::report;
use anyhow::Result;

/// Measures and writes docs/reports/cad.md. `args` go to the example: `--rays N` and STEP files.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    // Folders of files are the reader's own.
    let names = args.iter().map(|arg| arg.rsplit('/').next().unwrap_or(arg));
    let line: Vec<&str> = ["cargo xtask bench-cad"].into_iter().chain(names).collect();
    report::of_example("cad", "Exact surfaces", args, &line.join(" "))
}
