//! `cargo xtask fuzz`: runs the file readers on damaged input, until a failure or the end of the runs.

use crate::process;
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::Command;

/// A fuzz target, in tests/fuzz/fuzz_targets.
struct Target {
    name: &'static str,
    /// Maximum size of an input, bytes.
    size: u32,
    /// With AddressSanitizer, three times slower: for dependencies with unsafe Rust.
    sanitized: bool,
}

const TARGETS: [Target; 8] = [
    Target { name: "file", size: 1 << 15, sanitized: false },
    Target { name: "section", size: 1 << 14, sanitized: false },
    Target { name: "scene", size: 1 << 15, sanitized: false },
    Target { name: "links", size: 1 << 12, sanitized: false },
    Target { name: "gltf", size: 1 << 14, sanitized: true },
    Target { name: "shot", size: 1 << 11, sanitized: false },
    Target { name: "checkpoint", size: 1 << 15, sanitized: false },
    Target { name: "simplify", size: 400, sanitized: false },
];
/// Time limit for an input, seconds; a slower input is a failure.
const SLOW: u32 = 1;
#[derive(Debug, PartialEq)]
struct Options {
    targets: Vec<String>,
    runs: u64,
}

fn parse(args: &[String]) -> Result<Options> {
    let mut options = Options { targets: Vec::new(), runs: 100_000 };
    let mut args = args.iter();
    while let Some(name) = args.next() {
        match name.as_str() {
            "--runs" => {
                let value = args.next().context("--runs needs a value")?;
                options.runs = value.parse().context("--runs needs a number")?;
            }
            target if TARGETS.iter().any(|known| known.name == target) => {
                options.targets.push(target.to_owned())
            }
            other => {
                let names: Vec<_> = TARGETS.iter().map(|known| known.name).collect();
                bail!("there is no target or option {other}; there are {} and --runs", names.join(", "))
            }
        }
    }
    Ok(options)
}

/// Runs the targets, `runs` inputs each.
///
/// # Errors
/// If a target fails; the failing input is kept in tests/fuzz/artifacts.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    if process::quiet(Command::new("cargo").args(["+nightly", "fuzz", "--version"])).is_none() {
        println!(
            "installing cargo-fuzz: drives libFuzzer; it needs the nightly toolchain (rustup toolchain install nightly)"
        );
        process::run(process::cargo().args(["install", "--locked", "cargo-fuzz"]))?;
    }
    let work = process::target().join("fuzz");
    let seeds = work.join("seeds");
    process::run(
        process::cargo()
            .args(["run", "--locked", "--release", "--package", "rebounce-tests", "--bin", "seeds", "--"])
            .arg(&seeds),
    )?;
    for target in &TARGETS {
        if !options.targets.is_empty() && !options.targets.iter().any(|name| name == target.name) {
            continue;
        }
        let corpus = work.join("corpus").join(target.name);
        std::fs::create_dir_all(&corpus).with_context(|| corpus.display().to_string())?;
        fuzz(target, &[&corpus, &seeds.join(target.name)], options.runs)?;
    }
    println!("{} runs of each target: no failure", options.runs);
    Ok(())
}

/// Runs a target. The target aborts if an input needs more memory than four times its size plus 64 MB.
fn fuzz(target: &Target, folders: &[&Path], runs: u64) -> Result<()> {
    let sanitizer = if target.sanitized { "address" } else { "none" };
    let mut command = Command::new("cargo");
    command.args(["+nightly", "fuzz", "run", "--fuzz-dir", "tests/fuzz", "--sanitizer", sanitizer]);
    // One folder per kind of build, so that the builds do not invalidate each other.
    command.arg("--target-dir").arg(process::target().join("fuzz").join(sanitizer));
    command.arg(target.name).args(folders);
    command.arg("--").arg(format!("-runs={runs}")).arg(format!("-max_len={}", target.size));
    command.arg(format!("-timeout={SLOW}")).arg("-print_final_stats=1");
    process::run(command.current_dir(process::root()))
        .with_context(|| format!("target {0}: what failed is in tests/fuzz/artifacts/{0}", target.name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let wanted = Options { targets: vec!["gltf".into(), "links".into()], runs: 7 };
        assert_eq!(parse(&words("gltf --runs 7 links")).unwrap(), wanted);
        assert!(parse(&words("--runs")).is_err() && parse(&words("nothing")).is_err());
    }
}
