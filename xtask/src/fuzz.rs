//! `cargo xtask fuzz`: feeds damaged input to what reads files, until it breaks or the time is over.

use crate::process;
use anyhow::{Context, Result, bail};
use std::path::Path;
use std::process::Command;

/// The targets, in tests/fuzz/fuzz_targets, and what an input may weigh, bytes.
const TARGETS: [(&str, u32); 5] =
    [("file", 1 << 16), ("section", 1 << 16), ("links", 1 << 13), ("gltf", 1 << 15), ("shot", 1 << 11)];
/// An input that takes longer is a failure, seconds.
const SLOW: u32 = 1;
/// So is one that takes more memory than this at once, MB: 4 times the largest input and 64 MB.
const MALLOC_MB: u32 = 65;

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
            target if TARGETS.iter().any(|(name, _)| *name == target) => {
                options.targets.push(target.to_owned())
            }
            other => {
                let names: Vec<_> = TARGETS.iter().map(|(name, _)| *name).collect();
                bail!("there is no target or option {other}; there are {} and --runs", names.join(", "))
            }
        }
    }
    Ok(options)
}

/// Runs the targets, each so many times.
///
/// # Errors
/// If one fails: what failed is kept in tests/fuzz/artifacts.
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
            .args(["run", "--release", "--package", "rebounce-tests", "--bin", "seeds", "--"])
            .arg(&seeds),
    )?;
    for (target, size) in TARGETS {
        if !options.targets.is_empty() && !options.targets.iter().any(|name| name == target) {
            continue;
        }
        let corpus = work.join("corpus").join(target);
        std::fs::create_dir_all(&corpus).with_context(|| corpus.display().to_string())?;
        fuzz(target, size, &[&corpus, &seeds.join(target)], options.runs)?;
    }
    println!("{} runs of each target: no failure", options.runs);
    Ok(())
}

fn fuzz(target: &str, size: u32, folders: &[&Path], runs: u64) -> Result<()> {
    let mut command = Command::new("cargo");
    command.args(["+nightly", "fuzz", "run", "--fuzz-dir", "tests/fuzz", target]).args(folders);
    command.arg("--").arg(format!("-runs={runs}")).arg(format!("-max_len={size}"));
    command
        .arg(format!("-timeout={SLOW}"))
        .arg(format!("-malloc_limit_mb={MALLOC_MB}"))
        .arg("-print_final_stats=1");
    process::run(command.current_dir(process::root()))
        .with_context(|| format!("target {target}: what failed is in tests/fuzz/artifacts/{target}"))
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
