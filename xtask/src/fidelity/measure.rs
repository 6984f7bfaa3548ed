//! Runs `rebounce` and parses its output.

use super::cases::Case;
use crate::process;
use anyhow::{Context, Result};
use serde::Deserialize;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Output of `rebounce compare --json`.
#[derive(Clone, Debug, Deserialize)]
pub struct Comparison {
    error: Option<f64>,
    error_at_most: Option<f64>,
    pub bias: f64,
    pub p95: f64,
    pub flip: f64,
    #[serde(default)]
    spots: Vec<Spots>,
}

/// Spots on a bare wall, thousandths of a stop.
#[derive(Clone, Debug, Deserialize)]
struct Spots {
    deviation: f64,
    greatest: f64,
}

impl Comparison {
    /// The error; the upper bound of the error if hidden by the references' noise.
    pub fn error(&self) -> f64 {
        self.error.or(self.error_at_most).unwrap_or(f64::INFINITY)
    }

    /// Spots as a cell of a table: standard deviation and 99.5th percentile on each bare wall.
    pub fn spots_cell(&self) -> String {
        let walls = self.spots.iter().map(|wall| format!("{:.0}/{:.0}", wall.deviation, wall.greatest));
        walls.collect::<Vec<_>>().join(", ")
    }

    /// The error as a cell of a table.
    pub fn error_cell(&self) -> String {
        match self.error {
            Some(error) => format!("{error:.3}"),
            None => format!("under {:.3}", self.error()),
        }
    }
}

/// Fields of `rebounce bake --report` shown on the page.
#[derive(Debug, Deserialize)]
pub struct Report {
    pub promised_error: f64,
    pub triangles: u64,
    pub functions: u64,
    pub links: u64,
    pub later_links: u64,
    pub seconds: Vec<(String, f64)>,
    pub peak_memory_bytes: u64,
    pub file_bytes: u64,
}

/// Measurements of a bake.
pub struct Measured {
    pub scene: String,
    pub preset: String,
    pub report: Report,
    pub comparison: Comparison,
    /// Whether the scene is a generated scene.
    pub is_generated: bool,
}

/// The command `rebounce`, with a work folder.
pub struct Tool {
    rebounce: PathBuf,
    work: PathBuf,
}

/// Samples per pixel of renders.
const SAMPLES: u32 = 64;
/// Bounced light, as `--only` has it.
pub const INDIRECT: &str = "indirect";

impl Tool {
    pub fn new(work: PathBuf) -> Result<Self> {
        Self::built(process::target().join("release/rebounce"), work)
    }

    /// The tool with another build of the command.
    pub fn built(rebounce: PathBuf, work: PathBuf) -> Result<Self> {
        std::fs::create_dir_all(&work).with_context(|| work.display().to_string())?;
        Ok(Self { rebounce, work })
    }

    /// A file in the work folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.work.join(name)
    }

    /// The command with a verb.
    pub fn command(&self, verb: &str) -> Command {
        let mut command = Command::new(&self.rebounce);
        command.arg(verb);
        command
    }

    /// Path-traces the bounced light of a shot.
    pub fn reference(&self, case: &Case, seed: u64, samples: u32, out: &Path) -> Result<()> {
        self.path_traced(INDIRECT, (&case.scene, &case.view()), seed, samples, out)
    }

    /// Path-traces the light `only` of a scene in a view.
    pub fn path_traced(
        &self,
        only: &str,
        (scene, view): (&str, &[String]),
        seed: u64,
        samples: u32,
        out: &Path,
    ) -> Result<()> {
        let mut command = self.command("reference");
        command.arg(scene).args(view).args(["--only", only, "--seed", &seed.to_string()]);
        process::run(command.args(["--spp", &samples.to_string(), "-o"]).arg(out))
    }

    /// Bakes with the additional arguments `told`, renders the bounced light and compares; draws a panel if
    /// `shown`.
    pub fn measure(
        &self,
        case: &Case,
        preset: &str,
        told: &[String],
        shown: Option<&Path>,
    ) -> Result<Measured> {
        let (baked, report) = (self.file("scene.rbn"), self.file("report.json"));
        let mut bake = self.command("bake");
        bake.arg(&case.scene).args(["--preset", preset]).args(told);
        process::run(bake.arg("-o").arg(&baked).arg("--report").arg(&report))?;
        let picture = self.file("picture.exr");
        self.render(INDIRECT, &baked, &case.view(), &picture)?;
        let mut panel = Vec::new();
        if let Some(shown) = shown {
            panel.extend(["--panel".into(), shown.as_os_str().to_owned()]);
        }
        for wall in case.bare {
            panel.extend(["--spots".into(), (*wall).into()]);
        }
        let [a, b] = &case.references;
        Ok(Measured {
            is_generated: case.traced.is_none(),
            scene: case.name.clone(),
            preset: preset.to_owned(),
            report: serde_json::from_slice(&std::fs::read(&report)?).context("the bake's report")?,
            comparison: self.compare(&picture, a, Some(b), &panel)?,
        })
    }

    /// Light leak between two unconnected rooms, with light in one room: bounced radiance in the dark room over
    /// bounced radiance in the lit room.
    pub fn leak(&self, preset: &str) -> Result<f64> {
        let baked = self.file("two-rooms.rbn");
        process::run(self.command("bake").args(["builtin:two-rooms", "--preset", preset, "-o"]).arg(&baked))?;
        let lamp = serde_json::json!({
            "type": "spot", "position": [-2.2, 2.3, 2.6], "direction": [0.5, -1.0, -0.55],
            "outer_cone_deg": 55, "intensity": 60, "color": [1, 1, 1],
        });
        let take = |name: &str, side: f64| -> Result<PathBuf> {
            let shot = serde_json::json!({
                "size": [160, 90], "lights": [lamp],
                "camera": {
                    "position": [side * 3.6, 1.6, 3.6], "target": [side * 0.2, 1.0, 0.9], "up": [0, 1, 0],
                    "yfov_deg": 65,
                },
            });
            let (file, picture) =
                (self.file(&format!("{name}.shot.json")), self.file(&format!("{name}.exr")));
            std::fs::write(&file, shot.to_string())?;
            self.render(INDIRECT, &baked, &["--shot".to_owned(), file.display().to_string()], &picture)?;
            Ok(picture)
        };
        let (dark, lit) = (take("dark", 1.0)?, take("lit", -1.0)?);
        // The bias is the ratio of the means, minus 1.
        Ok(self.compare(&dark, &lit, None, &[])?.bias + 1.0)
    }

    /// Renders the light `only` of a file in a view.
    pub fn render(&self, only: &str, baked: &Path, view: &[String], out: &Path) -> Result<()> {
        let mut command = self.command("render");
        command.arg(baked).args(view).args(["--only", only, "--spp", &SAMPLES.to_string()]);
        process::run(command.arg("-o").arg(out))
    }

    pub fn compare(
        &self,
        picture: &Path,
        reference: &Path,
        second: Option<&Path>,
        more: &[std::ffi::OsString],
    ) -> Result<Comparison> {
        let mut command = self.command("compare");
        command.arg(picture).arg(reference).args(second).arg("--json").args(more);
        let printed = process::quiet(&mut command).with_context(|| process::line(&command))?;
        serde_json::from_str(&printed).context("rebounce compare")
    }
}
