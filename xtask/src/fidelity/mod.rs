//! `cargo xtask fidelity`: errors of baked scenes against path-traced references. Bakes, renders, path-traces,
//! compares, and writes docs/reports/fidelity.md with its tables and pictures. Duration: half an hour for the generated
//! scenes at `draft` and `standard`.

pub mod cases;
pub mod measure;
mod page;
mod path;

pub use cases::{given, given_or};

use crate::{process, report};
use anyhow::{Context, Result, bail};
use measure::Tool;
use std::path::PathBuf;

/// Presets measured when none are named.
const PRESETS: [&str; 2] = ["draft", "standard"];
/// Link thresholds of the curve, from coarse to fine.
const EPSILONS: [f32; 6] = [0.2, 0.1, 0.05, 0.02, 0.01, 0.005];

struct Options {
    presets: Vec<String>,
    scenes: Option<PathBuf>,
}

fn parse(args: &[String]) -> Result<Options> {
    let mut options = Options { presets: PRESETS.map(str::to_owned).to_vec(), scenes: cases::given() };
    let mut args = args.iter();
    while let Some(name) = args.next() {
        let mut value = || args.next().with_context(|| format!("{name} needs a value"));
        match name.as_str() {
            "--presets" => options.presets = value()?.split(',').map(str::to_owned).collect(),
            "--scenes" => options.scenes = Some(value()?.into()),
            other => bail!("there is no option {other}; there are --presets and --scenes"),
        }
    }
    Ok(options)
}

/// Measures everything and writes the page.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    process::run(process::cargo().args(["build", "--locked", "--release", "--package", "rebounce-cli"]))?;
    let tool = Tool::new(process::target().join("fidelity"))?;
    let mut cases = cases::generated(&tool)?;
    if let Some(folder) = &options.scenes {
        cases.extend(cases::in_folder(&tool, folder)?);
    }
    let pictures = report::folder().join("fidelity");
    std::fs::create_dir_all(&pictures).with_context(|| pictures.display().to_string())?;
    let mut page = page::Page::default();
    for case in &cases {
        for preset in &options.presets {
            // Pictures of third-party scenes stay out of the documentation.
            let shown = if case.traced.is_some() {
                tool.file(&case.picture_name())
            } else {
                pictures.join(case.picture_name())
            };
            let shown = (Some(preset) == options.presets.last()).then_some(shown);
            page.scenes.push(tool.measure(case, preset, &[], shown.as_deref())?);
        }
        if let Some(traced) = &case.traced {
            let [a, b] = &case.references;
            page.tracer.push((case.name.clone(), tool.compare(traced, a, Some(b), &[])?));
        }
    }
    for preset in &options.presets {
        page.leaks.push((preset.clone(), tool.leak(preset)?));
    }
    if let Some(case) = cases.iter().find(|case| case.name == "library") {
        for preset in &options.presets {
            tool.measure(case, preset, &[], None)?;
            page.steps.push((preset.clone(), tool.steps(Some(&tool.file("scene.rbn")))?));
        }
        page.steps.push(("path tracer".to_owned(), tool.steps(None)?));
        for epsilon in EPSILONS {
            let told = ["--epsilon".to_owned(), epsilon.to_string()];
            page.curve.push((epsilon, tool.measure(case, "draft", &told, None)?));
        }
        page::plot(&page.curve, &pictures.join("epsilon.svg"))?;
    }
    report::write("fidelity", "Fidelity", "cargo xtask fidelity", &page.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let options = parse(&words("--presets fine,draft --scenes some/where")).unwrap();
        assert_eq!(options.presets, ["fine", "draft"]);
        assert_eq!(options.scenes, Some("some/where".into()));
        assert!(parse(&words("--what")).is_err() && parse(&words("--presets")).is_err());
    }
}
