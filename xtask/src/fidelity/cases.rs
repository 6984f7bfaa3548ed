//! Test cases: a scene, a shot of the scene, and its path-traced references.

use super::measure::Tool;
use crate::process;
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// One shot of a scene.
pub struct Case {
    /// Name on the page.
    pub name: String,
    /// Scene argument of `rebounce bake`.
    pub scene: String,
    /// SHOT.json; the scene's first camera and lights when absent.
    pub shot: Option<PathBuf>,
    /// Width and height in pixels; from the shot when absent.
    pub size: Option<&'static str>,
    /// Two references of bounced light with independent noise.
    pub references: [PathBuf; 2],
    /// For references by another renderer: the same picture by the project's path tracer.
    pub traced: Option<PathBuf>,
    /// Bare walls in the picture for measuring spots: left, top, right, bottom, as shares of the picture.
    pub bare: &'static [&'static str],
}

/// Bare walls of a scene in its measured view.
fn bare(name: &str) -> &'static [&'static str] {
    match name {
        "attic" => &["0.03,0.30,0.36,0.62", "0.47,0.30,0.83,0.65"],
        "two-rooms-door" => &["0.12,0.30,0.36,0.70"],
        "gallery-walls" => &["0.68,0.30,0.98,0.62", "0.25,0.75,0.52,0.98"],
        _ => &[],
    }
}

/// Samples per pixel of each generated reference.
const SAMPLES: u32 = 256;
/// Samples per pixel of the path tracer's picture beside given references.
const TRACED_SAMPLES: u32 = 64;

impl Case {
    /// File name of the picture.
    pub fn picture_name(&self) -> String {
        format!("{}.png", self.name)
    }

    /// Path-traces missing pictures, with different seeds.
    fn trace(&self, tool: &Tool, pictures: &[PathBuf], samples: u32) -> Result<()> {
        for (seed, picture) in (11..).zip(pictures) {
            if !picture.exists() {
                tool.reference(self, seed, samples, picture)?;
            }
        }
        Ok(())
    }

    /// The shot and the size, as arguments.
    pub fn view(&self) -> Vec<String> {
        let mut args = Vec::new();
        if let Some(shot) = &self.shot {
            args.extend(["--shot".to_owned(), shot.display().to_string()]);
        }
        if let Some(size) = self.size {
            args.extend(["--size".to_owned(), size.to_owned()]);
        }
        args
    }
}

/// The generated scenes and the sizes of their pictures.
const GENERATED: [(&str, &str); 4] =
    [("attic", "480x270"), ("cornell-box", "240x240"), ("two-rooms-door", "320x180"), ("library", "320x180")];

/// The generated scenes; their references are computed once.
pub fn generated(tool: &Tool) -> Result<Vec<Case>> {
    named(tool, &GENERATED)
}

/// Built-in scenes of these names, in pictures of these sizes.
pub fn named(tool: &Tool, scenes: &[(&str, &'static str)]) -> Result<Vec<Case>> {
    scenes
        .iter()
        .copied()
        .map(|(name, size)| {
            let references = ["a", "b"].map(|which| tool.file(&format!("{name}.{which}.exr")));
            let case = Case {
                name: name.to_owned(),
                scene: format!("builtin:{name}"),
                shot: None,
                size: Some(size),
                references,
                traced: None,
                bare: bare(name),
            };
            case.trace(tool, &case.references, SAMPLES)?;
            Ok(case)
        })
        .collect()
}

/// Folder of scenes with finished references, if present beside the repository.
pub fn given() -> Option<PathBuf> {
    let folder = process::root().join("../shared/scenes");
    folder.join("shots").is_dir().then_some(folder)
}

/// A file of the folder of given scenes, or the `generated` scene if the file is missing.
pub fn given_or(file: &str, generated: &str) -> String {
    let known = given().map(|folder| folder.join(file)).filter(|file| file.exists());
    known.map_or_else(|| generated.to_owned(), |file| file.display().to_string())
}

/// Returns the shots of a folder: `shots/NAME.shot.json`, with the scene's name, and
/// `references/NAME.indirect.{a,b}.exr`.
pub fn in_folder(tool: &Tool, folder: &Path) -> Result<Vec<Case>> {
    let shots = folder.join("shots");
    let mut files: Vec<PathBuf> = std::fs::read_dir(&shots)
        .with_context(|| shots.display().to_string())?
        .filter_map(|entry| Some(entry.ok()?.path()))
        .collect();
    files.sort();
    let case = |file: &PathBuf| {
        let name = file.file_name()?.to_str()?.strip_suffix(".shot.json")?.to_owned();
        let shot: serde_json::Value = serde_json::from_slice(&std::fs::read(file).ok()?).ok()?;
        let references =
            ["a", "b"].map(|which| folder.join("references").join(format!("{name}.indirect.{which}.exr")));
        let scene = shots.join(shot.get("scene")?.as_str()?).display().to_string();
        let complete = references.iter().all(|file| file.exists());
        let bare = bare(&name);
        complete.then(|| Case {
            name,
            scene,
            shot: Some(file.clone()),
            size: None,
            references,
            traced: None,
            bare,
        })
    };
    let mut cases: Vec<Case> = files.iter().filter_map(case).collect();
    for case in &mut cases {
        let traced = tool.file(&format!("{}.traced.exr", case.name));
        case.trace(tool, std::slice::from_ref(&traced), TRACED_SAMPLES)?;
        case.traced = Some(traced);
    }
    Ok(cases)
}
