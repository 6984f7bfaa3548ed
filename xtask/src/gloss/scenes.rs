//! Shots of given scenes with gloss: error of all light against path-traced pictures, and panels of both.

use crate::fidelity::measure::{Comparison, Tool};
use crate::{process, report};
use anyhow::{Context, Result};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Samples a pixel of each of two references, where none are given.
const PATHS: u32 = 512;
/// All light, as `--only` has it.
const ALL: &str = "all";

/// A shot of a scene, and how its file is baked.
struct Case {
    name: &'static str,
    /// Shot below the folder of scenes.
    shot: &'static str,
    /// Environment in place of the shot's lights.
    sky: Option<&'static str>,
    /// What the file is for.
    purposes: &'static [&'static str],
}

const CASES: [Case; 4] = [
    Case {
        name: "statue-gloss",
        shot: "shots-later/statue-gloss",
        sky: None,
        purposes: &["room", "environment"],
    },
    Case {
        name: "statue-gloss-turned",
        shot: "shots-later/statue-gloss-turned",
        sky: None,
        purposes: &["room", "environment"],
    },
    Case { name: "country-kitchen-lamp", shot: "shots/country-kitchen", sky: None, purposes: &["room"] },
    Case {
        name: "country-kitchen-sky",
        shot: "shots/country-kitchen",
        sky: Some("environments/sky.hdr"),
        purposes: &["room"],
    },
];

/// Measures the shots that are in a folder; returns the section, with panels below docs/reports/gloss.
///
/// # Errors
/// If a step fails.
pub fn section(folder: &Path) -> Result<String> {
    process::run(process::cargo().args(["build", "--locked", "--release", "--package", "rebounce-cli"]))?;
    let tool = Tool::new(process::target().join("bench-gloss"))?;
    let panels = report::folder().join("gloss");
    std::fs::create_dir_all(&panels).with_context(|| panels.display().to_string())?;
    let mut rows = String::new();
    let mut pictures = String::new();
    for case in &CASES {
        let shot = folder.join(format!("{}.shot.json", case.shot));
        if !shot.exists() {
            continue;
        }
        let (shot, scene) = case.prepared(&shot, folder, &tool)?;
        let references = case.references(folder, &scene, &shot, &tool)?;
        for purpose in case.purposes {
            let (megabytes, found) = case.measured(&tool, (&scene, &shot), purpose, &references, &panels)?;
            let (error, bias) = (found.error_cell(), found.bias);
            writeln!(rows, "| {} | {purpose} | {megabytes:.1} | {error} | {bias:+.3} |", case.name)?;
        }
        writeln!(pictures, "\n![{0}: path traced, ours, difference](gloss/{0}.png)", case.name)?;
    }
    Ok(format!(
        "## Scenes\n\nAll light with `\"gloss\": true`, `standard`, 320 x 180 pixels. All pixels count, those of the sky\n\
         behind an object too, which agree. References of the statue are Mitsuba's, the others two pictures\n\
         of our path tracer with {PATHS} samples a pixel. *For*: `--for` of the bake. The country kitchen is by\n\
         Jay-Artist, CC BY 3.0; the statue is the Stanford bunny.\n\n\
         | shot | for | MB | error | bias |\n|---|---|---|---|---|\n{rows}{pictures}"
    ))
}

impl Case {
    /// Writes the shot with gloss, with whole paths; returns it and its scene.
    fn prepared(&self, shot: &Path, folder: &Path, tool: &Tool) -> Result<(PathBuf, String)> {
        let text = std::fs::read_to_string(shot).with_context(|| shot.display().to_string())?;
        let mut contents: Value = serde_json::from_str(&text).with_context(|| shot.display().to_string())?;
        let beside = |name: &str| -> Result<String> {
            let path = std::path::absolute(shot.with_file_name("").join(name))?;
            Ok(path.display().to_string())
        };
        let scene = beside(contents["scene"].as_str().context("the shot names no scene")?)?;
        contents["scene"] = scene.clone().into();
        contents["gloss"] = true.into();
        if let Some(sky) = self.sky {
            let file = std::path::absolute(folder.join(sky))?.display().to_string();
            contents["lights"] = json!([{ "type": "environment", "file": file, "intensity": 1 }]);
        }
        for light in contents["lights"].as_array_mut().into_iter().flatten() {
            if let Some(file) = light["file"].as_str() {
                light["file"] = beside(file)?.into();
            }
        }
        let out = tool.file(&format!("{}.shot.json", self.name));
        std::fs::write(&out, contents.to_string()).with_context(|| out.display().to_string())?;
        Ok((out, scene))
    }

    /// Two path-traced pictures: the given ones, or our own, which are kept.
    fn references(&self, folder: &Path, scene: &str, shot: &Path, tool: &Tool) -> Result<[PathBuf; 2]> {
        let given = ["a", "b"].map(|side| folder.join(format!("references/{}.all.{side}.exr", self.name)));
        if given.iter().all(|path| path.exists()) {
            return Ok(given);
        }
        let own = [1, 2].map(|seed| (seed, tool.file(&format!("{}-{seed}.exr", self.name))));
        for (seed, picture) in &own {
            if !picture.exists() {
                tool.path_traced(ALL, (scene, &view(shot)), *seed, PATHS, picture)?;
            }
        }
        Ok(own.map(|(_, picture)| picture))
    }

    /// Bakes, renders and compares; draws the panel of the first purpose.
    fn measured(
        &self,
        tool: &Tool,
        (scene, shot): (&str, &Path),
        purpose: &str,
        [a, b]: &[PathBuf; 2],
        panels: &Path,
    ) -> Result<(f64, Comparison)> {
        let (baked, picture) = (tool.file("scene.rbn"), tool.file("picture.exr"));
        process::run(tool.command("bake").arg(scene).args(["--for", purpose, "-o"]).arg(&baked))?;
        tool.render(ALL, &baked, &view(shot), &picture)?;
        let mut more = Vec::new();
        if Some(&purpose) == self.purposes.first() {
            more = vec!["--panel".into(), panels.join(format!("{}.png", self.name)).into_os_string()];
        }
        let bytes = std::fs::metadata(&baked).with_context(|| baked.display().to_string())?.len();
        Ok((bytes as f64 * 1e-6, tool.compare(&picture, a, Some(b), &more)?))
    }
}

/// A shot as arguments.
fn view(shot: &Path) -> [String; 2] {
    ["--shot".to_owned(), shot.display().to_string()]
}
