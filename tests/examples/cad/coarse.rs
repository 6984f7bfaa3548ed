//! Scenes of exact faces as few triangles: how they look where everybody else begins.

use anyhow::{Context, Result};
use rebounce::bake::{BakeSettings, Preset, bake};
use rebounce::scene::Scene;
use rebounce::scene::assembly::AssemblySettings;
use rebounce_cad::model::Assembly;
use std::path::Path;

/// Halvings of the search for a chord error.
const SEARCH: usize = 14;
/// Least and greatest factors of the chord error among which it searches. Beyond, outlines cross each other.
const COARSENESS: [f64; 2] = [1e-2, 40.0];

/// The assembly of `builtin:NAME` or of a STEP file.
fn assembly(spec: &str) -> Result<Assembly> {
    match spec.strip_prefix("builtin:") {
        Some(name) => rebounce_cad::demo::assembly(name).context("no such scene"),
        None => {
            let bytes = std::fs::read(spec).with_context(|| spec.to_owned())?;
            rebounce_cad::step::read(&bytes).with_context(|| spec.to_owned())
        }
    }
}

/// A scene of about as many triangles, without exact faces.
pub fn tessellated(spec: &str, count: usize) -> Result<Scene> {
    let (assembly, exact) = (assembly(spec)?, rebounce::io::load(spec)?);
    let [mut fine, mut coarse] = COARSENESS;
    let mut best: Option<Scene> = None;
    for _ in 0..SEARCH {
        let coarseness = (fine * coarse).sqrt();
        let settings = AssemblySettings { coarseness, ..AssemblySettings::default() };
        let scene = Scene::of_assembly(spec, exact.name.clone(), &assembly, &settings)?;
        let found = scene.triangles.len();
        if found > count {
            fine = coarseness
        } else {
            coarse = coarseness
        }
        let is_nearer =
            best.as_ref().is_none_or(|best| found.abs_diff(count) < best.triangles.len().abs_diff(count));
        if is_nearer {
            best = Some(scene);
        }
    }
    let mut scene = best.context("no tessellation")?;
    scene.brep = None;
    scene.cameras = exact.cameras;
    scene.lights = exact.lights;
    Ok(scene)
}

/// Bakes a scene of about so many triangles.
pub fn write(spec: &str, count: usize, out: &Path) -> Result<()> {
    let scene = tessellated(spec, count)?;
    let (file, report) = bake(&scene, &BakeSettings::new(Preset::Standard), &())?;
    std::fs::write(out, file.to_bytes()?).with_context(|| out.display().to_string())?;
    eprintln!("{} triangles\n{report}", scene.triangles.len());
    Ok(())
}
