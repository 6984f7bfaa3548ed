//! Scenes and pictures, made by `rebounce`.

use super::{Quality, SAMPLES, View, WALK, entries};
use crate::{process, web};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The scene of the comparison.
const COMPARED: &str = "library";

/// Builds missing or outdated scenes and pictures.
pub struct Maker<'a> {
    rebounce: &'a Path,
    work: PathBuf,
    quality: &'a Quality,
}

impl<'a> Maker<'a> {
    /// A maker with the program `rebounce` and the given quality.
    ///
    /// # Errors
    /// If the work folder cannot be created.
    pub fn new(rebounce: &'a Path, quality: &'a Quality) -> Result<Self> {
        let work = process::target().join("site-work").join(quality.key());
        fs::create_dir_all(&work).with_context(|| work.display().to_string())?;
        Ok(Self { rebounce, work, quality })
    }

    /// A baked scene, and the bake's report.
    ///
    /// # Errors
    /// If the bake fails.
    pub fn baked(&self, name: &str) -> Result<(PathBuf, PathBuf)> {
        let report = self.work.join(format!("{name}.json"));
        if !report.exists() {
            // The report is written after the scene.
            let _ = fs::remove_file(self.work.join(format!("{name}.rbn")));
        }
        let baked = self.made(&format!("{name}.rbn"), &[], |command| {
            match name {
                // From the kitchen into the living room.
                WALK => {
                    self.bake(command, Path::new("builtin:apartment"));
                    command.args(["--add", "builtin:walker", "--at", "2.65,0,1.2"]);
                }
                _ => self.bake(command, Path::new(&format!("builtin:{name}"))),
            }
            command.arg("--report").arg(&report);
        })?;
        Ok((baked, report))
    }

    /// The scenes that visitors may bake, `NAME.glb` in a folder, by the scripts of web/site/samples.
    ///
    /// # Errors
    /// If a script fails.
    pub fn samples(&self) -> Result<PathBuf> {
        let folder = self.work.join("samples");
        let scripts = entries(&process::root().join("web/site/samples"))?;
        let on: Vec<&Path> = scripts.iter().map(PathBuf::as_path).collect();
        if SAMPLES.iter().any(|name| is_stale(&folder.join(format!("{name}.glb")), &on)) {
            process::run(web::node().arg("site/samples/make.mjs").arg(&folder))?;
        }
        Ok(folder)
    }

    /// Renders a scene of a folder of samples with its own camera and lights, at half the common height.
    ///
    /// # Errors
    /// If baking or rendering fails.
    pub fn sample_picture(&self, samples: &Path, name: &str) -> Result<PathBuf> {
        let baked = self.baked_sample(samples, name)?;
        let high = self.quality.size[1] / 2;
        self.made(&format!("sample-{name}.png"), &[&baked], |command| {
            command.arg("render").arg(&baked).args(["--size", &format!("{}x{high}", high * 8 / 5)]);
        })
    }

    /// A sample, baked.
    ///
    /// # Errors
    /// If the bake fails.
    pub fn baked_sample(&self, samples: &Path, name: &str) -> Result<PathBuf> {
        let scene = samples.join(format!("{name}.glb"));
        self.made(&format!("sample-{name}.rbn"), &[&scene], |command| self.bake(command, &scene))
    }

    fn bake(&self, command: &mut Command, scene: &Path) {
        command.arg("bake").arg(scene).args(["--preset", &self.quality.preset]).args(&self.quality.bake);
    }

    /// Renders a view, at the common height; with the scene's first camera and lights if no shot is given.
    ///
    /// # Errors
    /// If rendering fails.
    pub fn picture(&self, view: &View, shot: Option<&Path>) -> Result<PathBuf> {
        let (baked, _) = self.baked(view.scene)?;
        let [width, height] = view.shape;
        let high = self.quality.size[1];
        let sources: Vec<&Path> = shot.into_iter().collect();
        self.made(&format!("{}.png", view.name), &sources, |command| {
            command.arg("render").arg(&baked).args(["--size", &format!("{}x{high}", high * width / height)]);
            command.args(sources.iter().flat_map(|shot| [Path::new("--shot"), *shot]));
        })
    }

    /// Panel of the path-traced picture, the relit picture (or a component of it), and their difference, side by
    /// side; and the relit picture's error.
    ///
    /// # Errors
    /// If a picture cannot be rendered or compared.
    pub fn panel(&self, name: &str, only: &str) -> Result<(PathBuf, f64)> {
        let truth = |seed: &str| {
            self.made(&format!("truth-{seed}.exr"), &[], |command| {
                command.args(["reference", &format!("builtin:{COMPARED}"), "--size", &self.size()]);
                command.args(["--seed", seed, "--spp", &self.quality.samples.to_string()]);
            })
        };
        let (first, second) = (truth("1")?, truth("2")?);
        let (baked, _) = self.baked(COMPARED)?;
        let picture = self.made(&format!("{name}.exr"), &[], |command| {
            command.arg("render").arg(&baked).args(["--size", &self.size(), "--only", only]);
        })?;
        let panel = self.work.join(format!("{name}.panel.png"));
        let mut compare = Command::new(self.rebounce);
        compare.arg("compare").args([&picture, &first, &second]).arg("--json").arg("--panel").arg(&panel);
        let line = process::line(&compare);
        let json = process::quiet(&mut compare).with_context(|| format!("`{line}` failed"))?;
        let found: serde_json::Value = serde_json::from_str(&json).context("rebounce compare")?;
        Ok((panel, found["error"].as_f64().context("rebounce compare gave no error")?))
    }

    fn size(&self) -> String {
        let [width, height] = self.quality.size;
        format!("{width}x{height}")
    }

    /// Returns a file of the work folder; runs `rebounce` with `arguments` and `-o` if the file is older than the
    /// program or a dependency in `on`.
    fn made(&self, name: &str, on: &[&Path], arguments: impl Fn(&mut Command)) -> Result<PathBuf> {
        let file = self.work.join(name);
        if is_stale(&file, &[&[self.rebounce], on].concat()) {
            let mut command = Command::new(self.rebounce);
            arguments(&mut command);
            process::run(command.arg("-o").arg(&file))?;
        }
        Ok(file)
    }
}

/// Whether a file is missing, or older than one that it depends on.
fn is_stale(file: &Path, on: &[&Path]) -> bool {
    let time = |path: &Path| fs::metadata(path).and_then(|data| data.modified()).ok();
    time(file).is_none_or(|made| on.iter().any(|path| time(path).is_none_or(|changed| made < changed)))
}
