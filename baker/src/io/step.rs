//! STEP files to [`Scene`]: AP203, AP214 and AP242.

use super::Files;
use super::options::LoadOptions;
use crate::scene::{Scene, SceneError};
#[cfg(feature = "step")]
use crate::scene::{
    assembly::{AssemblySettings, GREY},
    groups::MaterialGroup,
};
use std::path::Path;

/// Whether a path has the ending of a STEP file.
pub fn is_step(path: &Path) -> bool {
    let ending = path.extension().and_then(|ending| ending.to_str());
    ending.is_some_and(|ending| ["step", "stp", "p21"].iter().any(|known| ending.eq_ignore_ascii_case(known)))
}

/// Loads a STEP file.
pub(super) fn load(files: &dyn Files, path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    let file = path.display().to_string();
    let bytes = files.read(path).map_err(|source| SceneError::Read { path: file.clone(), source })?;
    let name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    convert(&file, name, &bytes, options)
}

#[cfg(feature = "step")]
fn convert(file: &str, name: String, bytes: &[u8], options: &LoadOptions) -> Result<Scene, SceneError> {
    options.at_rest(file)?;
    if let Some(wanted) = options.scene.clone() {
        let advice = "leave --scene out, as it is one scene".to_owned();
        return Err(SceneError::NoScene { file: file.to_owned(), wanted, advice });
    }
    let assembly = rebounce_cad::step::read(bytes)
        .map_err(|error| SceneError::Step { file: file.to_owned(), problem: error.to_string() })?;
    let group =
        |option: &super::GroupOption| MaterialGroup { name: option.name.clone(), density: option.density };
    let settings = AssemblySettings {
        grey: options.albedo.unwrap_or(GREY),
        groups: options.groups.iter().map(group).collect(),
        ..AssemblySettings::default()
    };
    Scene::of_assembly(file, name, &assembly, &settings)
}

#[cfg(not(feature = "step"))]
fn convert(file: &str, _: String, _: &[u8], _: &LoadOptions) -> Result<Scene, SceneError> {
    Err(SceneError::WithoutFeature { what: file.to_owned(), feature: "step" })
}
