//! `cargo xtask bench-gloss`: a metal trophy under two environments beside the path tracer, with glossy transfer of several
//! kinds and sizes; writes docs/reports/gloss.md.

use crate::{process, report};
use anyhow::{Context, Result, bail};

/// Title of the page.
const TITLE: &str = "Glossy transfer";

/// Measures and writes the page; `--quick` prints coarse figures and leaves the page as it is.
///
/// # Errors
/// If the measurement fails.
pub fn run(args: &[String]) -> Result<()> {
    let is_quick = match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [] => false,
        ["--quick"] => true,
        _ => bail!("cargo xtask bench-gloss has no option but --quick"),
    };
    let mut command = process::cargo();
    command.args(["run", "--locked", "--package", "rebounce-benches", "--example", "gloss", "--"]).args(args);
    let figures = process::quiet(&mut command).with_context(|| process::line(&command))?;
    println!("{figures}");
    if is_quick { Ok(()) } else { report::write("gloss", TITLE, "cargo xtask bench-gloss", &figures) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_options_are_refused() {
        assert!(run(&["--what".to_owned()]).is_err());
    }
}
