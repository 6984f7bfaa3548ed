//! `cargo xtask refine`: the adaptive gather beside pairwise links, at equal bytes and at equal seconds. Bakes each scene both
//! ways with several numbers of functions, compares with the path tracer, and writes docs/reports/refine.md.

use crate::fidelity::cases::{self, Case};
use crate::fidelity::measure::{Comparison, INDIRECT, Tool};
use crate::{process, report};
use anyhow::{Context, Result, ensure};
use serde::Deserialize;
use std::fmt::Write;
use std::path::Path;

/// Scenes and the sizes of their pictures: a box, a door that light passes, and a room lit through a small window.
const SCENES: [(&str, &str); 3] =
    [("cornell-box", "160x160"), ("two-rooms-door", "240x135"), ("attic", "240x135")];
/// Functions on the finest level of each bake, and levels, so that the coarsest level is about as large.
const SIZES: [(&str, &str); 3] = [("3K", "4"), ("12K", "5"), ("48K", "6")];
/// Ways to refine, as `--refine` names them.
const WAYS: [&str; 2] = ["gather", "pairwise"];

/// A bake and its error.
struct Run {
    way: &'static str,
    functions: &'static str,
    /// Processor seconds of the whole bake.
    seconds: f64,
    bytes: f64,
    links: u64,
    rays: u64,
    comparison: Comparison,
}

/// Fields of `rebounce bake --report`.
#[derive(Deserialize)]
struct Figures {
    links: u64,
    rays: u64,
    file_bytes: u64,
}

/// Field of the last line of `rebounce bake --json-progress`.
#[derive(Deserialize)]
struct Done {
    processor_seconds: f64,
}

/// Measures and writes the page.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    ensure!(args.is_empty(), "cargo xtask refine has no options");
    process::run(process::cargo().args(["build", "--locked", "--package", "rebounce-cli"]))?;
    let tool = Tool::built(process::target().join("debug/rebounce"), process::target().join("refine"))?;
    let (mut all, mut equal) = (String::new(), String::new());
    for case in &cases::named(&tool, &SCENES)? {
        let mut runs = Vec::new();
        for way in WAYS {
            for (functions, levels) in SIZES {
                runs.push(measure(&tool, case, way, (functions, levels))?);
            }
        }
        for run in &runs {
            writeln!(all, "| {} {}", case.name, row(run))?;
        }
        for (what, of) in [("bytes", bytes as fn(&Run) -> f64), ("seconds", seconds)] {
            writeln!(equal, "| {} | {what} {}", case.name, equal_row(&runs, what, of))?;
        }
    }
    let figures = format!("{}", Page { all: &all, equal: &equal });
    report::write("refine", "Adaptive gather and pairwise links", "cargo xtask refine", &figures)
}

fn bytes(run: &Run) -> f64 {
    run.bytes
}

fn seconds(run: &Run) -> f64 {
    run.seconds
}

/// Bakes a scene and compares its bounced light with the path tracer.
fn measure(
    tool: &Tool,
    case: &Case,
    way: &'static str,
    (functions, levels): (&'static str, &str),
) -> Result<Run> {
    let (baked, told) = (tool.file("scene.rbn"), tool.file("report.json"));
    let mut bake = tool.command("bake");
    bake.arg(&case.scene).args(["--preset", "draft", "--functions", functions, "--levels", levels]);
    bake.args(["--refine", way, "--json-progress", "-o"]).arg(&baked).arg("--report").arg(&told);
    let printed = process::quiet(&mut bake).with_context(|| process::line(&bake))?;
    let last = printed.lines().last().context("the bake said nothing")?;
    let done: Done = serde_json::from_str(last).context("the last line of the bake")?;
    let figures: Figures = read(&told)?;
    let picture = tool.file("picture.exr");
    tool.render(INDIRECT, &baked, &case.view(), &picture)?;
    let [a, b] = &case.references;
    let comparison = tool.compare(&picture, a, Some(b), &[])?;
    let Figures { links, rays, file_bytes } = figures;
    let (seconds, bytes) = (done.processor_seconds, file_bytes as f64);
    Ok(Run { way, functions, seconds, bytes, links, rays, comparison })
}

fn read(path: &Path) -> Result<Figures> {
    serde_json::from_slice(&std::fs::read(path)?).with_context(|| path.display().to_string())
}

/// Cells of a bake, after the scene's.
fn row(run: &Run) -> String {
    let Run { way, functions, seconds, bytes, links, rays, comparison } = run;
    format!(
        "| {functions} | {way} | {} | {:+.3} | {:.2} | {seconds:.1} | {} | {:.1} |",
        comparison.error_cell(),
        comparison.bias,
        bytes / 1e6,
        links / 1000,
        *rays as f64 / 1e6,
    )
}

/// Value of a curve through points (x, y), both over 0, at `x`: straight lines between logarithms; `None` beyond the points.
fn on_curve(points: &[(f64, f64)], x: f64) -> Option<f64> {
    points.windows(2).find_map(|pair| {
        let [(x0, y0), (x1, y1)] = [pair[0], pair[1]];
        let along = (x / x0).ln() / (x1 / x0).ln();
        (0.0..=1.0).contains(&along).then(|| (y0.ln() + along * (y1 / y0).ln()).exp())
    })
}

/// Cells of both errors at equal `of`: in the middle of the range that both have.
fn equal_row(runs: &[Run], what: &str, of: fn(&Run) -> f64) -> String {
    let curve = |way: &str| -> Vec<(f64, f64)> {
        runs.iter().filter(|run| run.way == way).map(|run| (of(run), run.comparison.error())).collect()
    };
    let [gather, pairwise] = WAYS.map(curve);
    let ends = |curve: &[(f64, f64)]| Some([curve.first()?.0, curve.last()?.0]);
    let both = ends(&gather).zip(ends(&pairwise));
    let at = both.map(|(a, b)| (a[0].max(b[0]) * a[1].min(b[1])).sqrt());
    let errors = at.and_then(|at| Some((at, on_curve(&gather, at)?, on_curve(&pairwise, at)?)));
    let Some((at, gather, pairwise)) = errors else { return "| no common range | | |".to_owned() };
    let at = if what == "bytes" { format!("{:.2} MB", at / 1e6) } else { format!("{at:.1} s") };
    format!("| {at} | {gather:.3} | {pairwise:.3} |")
}

/// The page, with its rows.
struct Page<'a> {
    all: &'a str,
    equal: &'a str,
}

impl std::fmt::Display for Page<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "Preset `draft` with the functions named, `--refine gather` and `--refine pairwise`. Error: RMS\n\
             difference of bounced light from two path-traced pictures of 256 samples a pixel, over their mean;\n\
             \"under\" where their noise hides it. Seconds are those of the processor, all threads and the whole\n\
             bake; bytes are the file's. Command built with the `dev` profile (`opt-level` 2), both ways alike.\n\n\
             ## At equal bytes and at equal seconds\n\n\
             In the middle of the range that both curves below have, interpolated between logarithms.\n\n\
             | scene | equal | at | error, gather | error, pairwise |\n|---|---|---|---|---|\n{}\n\
             ## All bakes\n\n\
             | scene | functions | refine | error | bias | MB | s | thousand links | million rays |\n\
             |---|---|---|---|---|---|---|---|---|\n{}\n",
            self.equal, self.all
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_straight_between_logarithms_and_end_at_their_points() {
        let points = [(1.0, 0.4), (4.0, 0.1), (16.0, 0.1)];
        assert_eq!(on_curve(&points, 1.0), Some(0.4));
        assert!((on_curve(&points, 2.0).unwrap() - 0.2).abs() < 1e-12);
        assert!((on_curve(&points, 9.0).unwrap() - 0.1).abs() < 1e-12);
        assert_eq!(on_curve(&points, 0.5), None);
        assert_eq!(on_curve(&points, 17.0), None);
        assert!(run(&["--what".to_owned()]).is_err());
    }
}
