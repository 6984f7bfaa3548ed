//! `cargo xtask bench-cad`: exact surfaces beside triangles: lost hits, rays a second, wavelet radiosity.

use crate::report;
use anyhow::Result;

/// Measures and writes docs/reports/cad.md. `args` go to the example: `--rays N`, `--quick` and STEP files. With `--wavelets` tables
/// of some scenes are printed alone.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    if args.iter().any(|arg| arg == "--wavelets") {
        println!("{}", report::printed_by("rebounce-tests", "cad", args)?);
        return Ok(());
    }
    // Folders of files are the reader's own.
    let names = args.iter().map(|arg| arg.rsplit('/').next().unwrap_or(arg));
    let line: Vec<&str> = ["cargo xtask bench-cad"].into_iter().chain(names).collect();
    report::of_example("cad", "Exact surfaces and wavelet radiosity", args, &line.join(" "))
}
