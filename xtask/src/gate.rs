//! `cargo xtask check`: what must hold before a commit: format, order of modules, names, the docs, lints, documentation of
//! the code, and the library without its features and for wasm. `tsc` checks the page when it is built, strictly.

use crate::{docs, layers, names, process, sources, toolchain};
use anyhow::{Result, bail};

/// Name of a check, and the check.
type Check = (&'static str, fn() -> Result<()>);

/// Those that read the sources.
const TEXT: [Check; 4] =
    [("format", format), ("layers", layers::run), ("names", names::run), ("docs", docs::run)];
/// Those that compile them, each with metadata of its own: minutes of processor time.
const COMPILED: [Check; 3] = [("lints", lints), ("rustdoc", rustdoc), ("wasm", wasm)];

/// Runs all checks.
///
/// # Errors
/// If a check fails.
pub fn run() -> Result<()> {
    each(&[&TEXT[..], &COMPILED].concat())
}

/// Runs the checks that compile nothing.
///
/// # Errors
/// If a check fails.
pub fn text() -> Result<()> {
    each(&TEXT)
}

/// Runs checks; a failed one does not stop later ones.
fn each(checks: &[Check]) -> Result<()> {
    let mut failed = Vec::new();
    for (name, check) in checks {
        if let Err(error) = check() {
            println!("{error:#}");
            failed.push(*name);
        }
    }
    if !failed.is_empty() {
        bail!("these checks failed: {}", failed.join(", "));
    }
    Ok(())
}

fn format() -> Result<()> {
    process::run(process::cargo().args(["fmt", "--all", "--", "--check"]))
}

/// Compiler and Clippy, with warnings denied.
fn lints() -> Result<()> {
    let mut command = process::cargo();
    command.args(["clippy", "--locked", "--workspace", "--features", sources::STEP, "--all-targets"]);
    process::run(command.args(["--", "--deny", "warnings"]))
}

/// Documentation of the code, with warnings denied: missing pages and dead links.
fn rustdoc() -> Result<()> {
    let mut command = process::cargo();
    command.args(["doc", "--locked", "--workspace", "--features", sources::STEP]);
    command.args(["--no-deps", "--document-private-items"]);
    process::run(command.env("RUSTDOCFLAGS", "--deny warnings"))
}

/// The library for wasm, without features and with those that need no operating system.
fn wasm() -> Result<()> {
    let toolchain = toolchain::find()?;
    for features in ["", "gltf,demo-scenes"] {
        let mut command = toolchain.cargo("check");
        command.args(["--package", "rebounce", "--no-default-features", "--features", features]);
        command.args(["--profile", "web"]);
        process::run(command.env("RUSTFLAGS", "--deny warnings"))?;
    }
    Ok(())
}
