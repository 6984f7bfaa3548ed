//! Solutions by the command, their pictures, and their errors.

use crate::{process, report};
use anyhow::{Context, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Folder of the plots, beside the report.
pub const FOLDER: &str = "antiradiance";
/// Size of the pictures.
const SIZE: &str = "240x180";
/// Points of the files: more than patches, so that the error is the solution's.
const FUNCTIONS: &str = "25K";

/// Output of `rebounce compare --json`.
#[derive(Debug, Deserialize)]
struct Compared {
    error: Option<f64>,
    error_at_most: Option<f64>,
    bias: f64,
}

/// Used fields of `rebounce solve --report`.
#[derive(Debug, Deserialize)]
struct Report {
    antiradiance: Option<Work>,
}

#[derive(Debug, Deserialize)]
struct Work {
    bins: u64,
    elements: u64,
    links: u64,
    transfers: u64,
    iterations: u32,
    link_seconds: f64,
    global_seconds: f64,
    local_seconds: f64,
    differences: Vec<Option<f64>>,
    bytes: u64,
}

/// A solution and its error.
#[derive(Debug)]
pub struct Solved {
    work: Work,
    /// Relative RMS.
    pub error: f64,
    bias: f64,
}

impl Solved {
    /// Head of a table of solutions.
    pub const HEAD: &str = "| bins | elements | links, M | form factors, M | steps | linking, s | global, ms | local, ms | MB | error | bias |\n\
                            |---|---|---|---|---|---|---|---|---|---|---|";

    /// A row of the table.
    pub fn row(&self) -> String {
        let of = &self.work;
        let ms = |seconds: f64| 1e3 * seconds / f64::from(of.iterations.max(1));
        format!(
            "| {} | {} | {:.2} | {:.2} | {} | {:.1} | {:.0} | {:.0} | {:.0} | {:.3} | {:+.3} |",
            of.bins,
            of.elements,
            of.links as f64 / 1e6,
            of.transfers as f64 / 1e6,
            of.iterations,
            of.link_seconds,
            ms(of.global_seconds),
            ms(of.local_seconds),
            of.bytes as f64 / 1e6,
            self.error,
            self.bias
        )
    }

    /// Number of bins, for a plot.
    pub fn bins(&self) -> f64 {
        self.work.bins as f64
    }

    /// Number of elements, for a plot.
    pub fn elements(&self) -> f64 {
        self.work.elements as f64
    }
}

/// Runs the command in a folder of its own.
pub struct Recorder {
    work: PathBuf,
    spp: String,
}

impl Recorder {
    /// Makes the folders.
    ///
    /// # Errors
    /// If they cannot be made.
    pub fn new(spp: &str) -> Result<Self> {
        let work = process::target().join("antiradiance");
        for folder in [&work, &report::folder().join(FOLDER)] {
            std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
        }
        Ok(Self { work, spp: spp.to_owned() })
    }

    /// Path of a plot.
    pub fn plot(&self, name: &str) -> PathBuf {
        report::folder().join(FOLDER).join(format!("{name}.svg"))
    }

    fn file(&self, name: &str) -> PathBuf {
        self.work.join(name)
    }

    fn command(&self, verb: &str) -> Command {
        let mut command = Command::new(process::target().join("release/rebounce"));
        command.arg(verb);
        command
    }

    /// Two references of a scene, with noise of their own; kept for the next run.
    fn references(&self, scene: &str) -> Result<[PathBuf; 2]> {
        let take = |seed: &str| -> Result<PathBuf> {
            let out = self.file(&format!("{scene}-{}-{seed}.exr", self.spp));
            if !out.exists() {
                let mut command = self.command("reference");
                command.arg(format!("builtin:{scene}")).args(["--only", "indirect", "--size", SIZE]);
                process::run(command.args(["--spp", &self.spp, "--seed", seed, "-o"]).arg(&out))?;
            }
            Ok(out)
        };
        Ok([take("1")?, take("2")?])
    }

    /// Solves; returns the report.
    fn solve(&self, scene: &str, args: &[&str]) -> Result<Report> {
        let report = self.file("report.json");
        let mut command = self.command("solve");
        command.arg(format!("builtin:{scene}")).args(["--functions", FUNCTIONS]).args(args);
        process::run(command.arg("-o").arg(self.file("scene.rbn")).arg("--report").arg(&report))?;
        read(&report)
    }

    /// Error and bias of the last solution of a scene.
    fn error(&self, scene: &str) -> Result<(f64, f64)> {
        let picture = self.file("picture.exr");
        self.render(&picture)?;
        self.compare(&picture, &self.references(scene)?)
    }

    fn render(&self, picture: &Path) -> Result<()> {
        let mut render = self.command("render");
        render.arg(self.file("scene.rbn")).args(["--only", "indirect", "--size", SIZE, "-o"]);
        process::run(render.arg(picture))
    }

    fn compare(&self, picture: &Path, references: &[PathBuf]) -> Result<(f64, f64)> {
        let mut compare = self.command("compare");
        compare.arg(picture).args(references).arg("--json");
        let text = process::quiet(&mut compare).context("the pictures could not be compared")?;
        let found: Compared = serde_json::from_str(&text)?;
        Ok((found.error.or(found.error_at_most).unwrap_or(f64::INFINITY), found.bias))
    }

    /// Solves by antiradiance with these arguments, and compares.
    ///
    /// # Errors
    /// If a command fails.
    pub fn measured(&self, scene: &str, args: &[&str]) -> Result<Solved> {
        let report = self.solve(scene, &[&["--solver", "antiradiance"], args].concat())?;
        let (error, bias) = self.error(scene)?;
        let work = report.antiradiance.context("the report has no figures of antiradiance")?;
        Ok(Solved { work, error, bias })
    }

    /// The row of radiosity with visibility, with this variation of light that refines a function.
    ///
    /// # Errors
    /// If a command fails.
    pub fn radiosity(&self, scene: &str, epsilon: &str) -> Result<String> {
        self.solve(scene, &["--epsilon", epsilon])?;
        let (error, bias) = self.error(scene)?;
        Ok(format!("| radiosity, ε {epsilon} | – | – | – | – | – | – | – | – | {error:.3} | {bias:+.3} |"))
    }

    /// Solves by each iteration, given by its arguments and its number of steps, and compares the pictures with the last iteration's.
    ///
    /// # Errors
    /// If a command fails.
    pub fn steps(&self, scene: &str, args: &[&str], iterations: &[(&[&str], usize)]) -> Result<Vec<Steps>> {
        let picture = |number: usize| self.file(&format!("iteration-{number}.exr"));
        let mut found = Vec::new();
        for (number, (iteration, count)) in iterations.iter().enumerate() {
            let count = count.to_string();
            let fixed = ["--solver", "antiradiance", "--change", "0", "--iterations", &count];
            let all = [&fixed, args, *iteration].concat();
            let report = self.solve(scene, &all)?;
            self.render(&picture(number))?;
            let work = report.antiradiance.context("the report has no figures of antiradiance")?;
            found.push(work.differences.into_iter().map(|own| own.unwrap_or(f64::NAN)).collect());
        }
        let last = picture(iterations.len().saturating_sub(1));
        let steps = |(number, differences)| {
            // A picture of light that diverged has no error.
            let from_last =
                self.compare(&picture(number), std::slice::from_ref(&last)).map_or(f64::NAN, |own| own.0);
            Steps { differences, from_last }
        };
        Ok(found.into_iter().enumerate().map(steps).collect())
    }
}

/// Convergence of an iteration.
#[derive(Debug)]
pub struct Steps {
    /// Difference of the light after each step from that after its last step, a share of it.
    pub differences: Vec<f64>,
    /// Relative RMS of the picture from that of the last iteration.
    pub from_last: f64,
}

fn read(report: &Path) -> Result<Report> {
    let text = std::fs::read_to_string(report).with_context(|| report.display().to_string())?;
    serde_json::from_str(&text).with_context(|| report.display().to_string())
}
