//! `cargo xtask bench-gloss`: a metal trophy under two environments beside the path tracer, with glossy transfer of several
//! kinds and sizes, and shots of given scenes; writes docs/reports/gloss.md.

mod scenes;

use crate::fidelity::given;
use crate::{process, report};
use anyhow::{Context, Result, bail};
use std::path::PathBuf;

/// Title of the page.
const TITLE: &str = "Glossy transfer";

/// What is measured.
#[derive(Debug, Default, PartialEq)]
struct Options {
    is_quick: bool,
    scenes: Option<PathBuf>,
}

fn parse(args: &[String]) -> Result<Options> {
    let mut options = Options { scenes: given(), ..Options::default() };
    let mut args = args.iter();
    while let Some(name) = args.next() {
        match name.as_str() {
            "--quick" => options.is_quick = true,
            "--scenes" => options.scenes = Some(args.next().context("--scenes needs a folder")?.into()),
            other => bail!("there is no option {other}; there are --quick and --scenes"),
        }
    }
    Ok(options)
}

/// Measures and writes the page; `--quick` prints coarse figures of the trophy and leaves the page as it is.
///
/// # Errors
/// If the measurement fails.
pub fn run(args: &[String]) -> Result<()> {
    let Options { is_quick, scenes: folder } = parse(args)?;
    let mut command = process::cargo();
    command.args(["run", "--locked", "--package", "rebounce-benches", "--example", "gloss", "--"]);
    command.args(is_quick.then_some("--quick"));
    let mut figures = process::quiet(&mut command).with_context(|| process::line(&command))?;
    println!("{figures}");
    if is_quick {
        return Ok(());
    }
    if let Some(folder) = folder {
        let section = scenes::section(&folder)?;
        println!("{section}");
        figures = format!("{}\n\n{section}", figures.trim_end());
    }
    report::write("gloss", TITLE, "cargo xtask bench-gloss", &figures)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_options_are_refused() {
        assert!(parse(&["--what".to_owned()]).is_err());
        assert!(parse(&["--scenes".to_owned()]).is_err());
        let options = parse(&["--scenes", "a/b", "--quick"].map(str::to_owned)).unwrap();
        assert_eq!(options, Options { is_quick: true, scenes: Some("a/b".into()) });
    }
}
