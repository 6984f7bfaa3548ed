//! `cargo xtask damage`: opens damaged files in headless Chromium, through the element; with `--scenes`, bakes damaged
//! scenes with the native program and as WebAssembly.

use crate::{install, npm, process, web};
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};

struct Options {
    files: u32,
    seed: u64,
    /// Damaged copies of each scene to bake, in place of opening files.
    scenes: Option<u32>,
}

fn parse(args: &[String]) -> Result<Options> {
    let mut options = Options { files: 2000, seed: 1, scenes: None };
    let mut args = args.iter();
    while let Some(name) = args.next() {
        let value = || args.clone().next().with_context(|| format!("{name} needs a value"));
        match name.as_str() {
            "--files" => options.files = value()?.parse().context("--files needs a number")?,
            "--seed" => options.seed = value()?.parse().context("--seed needs a number")?,
            "--scenes" => options.scenes = Some(value()?.parse().context("--scenes needs a number")?),
            other => bail!("there is no option {other}; there are --files, --scenes and --seed"),
        }
        args.next();
    }
    Ok(options)
}

/// Makes the files, builds the viewer, and opens the files: the viewer must refuse a file or render a picture.
///
/// # Errors
/// If the viewer does neither; the files stay in target/damage.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    install::ensure(&install::BROWSER)?;
    web::build(web::Purpose::Publish)?;
    let folder = process::target().join("damage");
    if let Some(copies) = options.scenes {
        return bake(&folder, copies, options.seed);
    }
    if folder.exists() {
        std::fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    }
    let numbers = [options.files.to_string(), options.seed.to_string()];
    process::run(std::process::Command::new(program("damage")?).arg(&folder).args(numbers))?;
    process::run(web::node().arg("test/damaged.mjs").arg(&folder))?;
    // Files without fault are not needed again.
    std::fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())
}

/// Bakes damaged copies of scenes with the native program and as WebAssembly: both must come to the same.
fn bake(folder: &Path, copies: u32, seed: u64) -> Result<()> {
    npm::build(web::Purpose::Publish)?;
    process::run(process::cargo().args(["build", "--locked", "--package", "rebounce-cli"]))?;
    let rebounce = process::target().join("debug/rebounce");
    let numbers = [copies.to_string(), seed.to_string()];
    process::run(web::node().arg("test/hostile.mjs").arg(folder).arg(rebounce).args(numbers))
}

/// Builds a program of the test crate with the tests' settings; returns the program's path.
fn program(name: &str) -> Result<PathBuf> {
    process::run(process::cargo().args(["build", "--package", "rebounce-tests", "--bin", name]))?;
    Ok(process::target().join("debug").join(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let options = parse(&words("--seed 9 --files 7")).unwrap();
        assert_eq!((options.files, options.seed), (7, 9));
        assert_eq!(parse(&[]).unwrap().files, 2000);
        assert!(parse(&words("--files")).is_err() && parse(&words("--files many")).is_err());
        assert!(parse(&words("--file 7")).is_err());
    }
}
