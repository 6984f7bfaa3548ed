//! Loading of a scene by name.

use super::Files;
use super::files::Disk;
#[cfg(feature = "demo-scenes")]
use super::files::Memory;
use super::options::LoadOptions;
#[cfg(feature = "demo-scenes")]
use super::options::UNUSED_ALBEDO;
use super::step;
use crate::scene::{Scene, SceneError};
use std::path::Path;

/// Loads a scene: the path of a .gltf, .glb, .step or .stp file, or `builtin:NAME`.
///
/// # Errors
/// [`SceneError`], with the file's name and advice.
pub fn load(spec: &str) -> Result<Scene, SceneError> {
    load_with(spec, &LoadOptions::default())
}

/// Loads a scene with options. `builtin:NAME` is a single scene, and all meshes of built-in scenes have materials; but for
/// `builtin:walker`, which is a file as others.
///
/// # Errors
/// [`SceneError`], with the file's name and advice.
pub fn load_with(spec: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    load_by_name(&Disk, spec, options)
}

/// As [`load_with`], from any source of files.
///
/// # Errors
/// [`SceneError`], with the file's name and advice.
pub fn load_by_name(files: &dyn Files, spec: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    match spec.strip_prefix("builtin:") {
        Some(name) => builtin(spec, name, options),
        None => file(files, spec, options),
    }
}

fn file(files: &dyn Files, path: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    load_from(files, Path::new(path), options)
}

#[cfg(feature = "demo-scenes")]
fn builtin(spec: &str, name: &str, options: &LoadOptions) -> Result<Scene, SceneError> {
    if let Some(bytes) = crate::demo::file(name) {
        let path = format!("{name}.glb");
        return file(&Memory::from_iter([(path.clone(), bytes)]), &path, options);
    }
    if let Some(wanted) = options.scene.clone() {
        return Err(SceneError::NoScene {
            file: spec.to_owned(),
            wanted,
            advice: "leave --scene out, as it is one scene".to_owned(),
        });
    }
    options.at_rest(spec)?;
    let mut scene = crate::demo::load(name)?;
    scene.notes.extend(options.albedo.map(|_| UNUSED_ALBEDO.to_owned()));
    Ok(scene)
}

#[cfg(not(feature = "demo-scenes"))]
fn builtin(spec: &str, _: &str, _: &LoadOptions) -> Result<Scene, SceneError> {
    Err(SceneError::WithoutFeature { what: spec.to_owned(), feature: "demo-scenes" })
}

/// Loads a .gltf, .glb, .step or .stp file from any source of files: a disk ([`Disk`]), memory
/// ([`Memory`](super::files::Memory)). Files that the scene refers to are looked up beside the scene's file.
///
/// # Errors
/// [`SceneError`], with the file's name and advice.
pub fn load_from(files: &dyn Files, path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    match step::is_step(path) {
        true => step::load(files, path, options),
        false => gltf(files, path, options),
    }
}

#[cfg(feature = "gltf")]
fn gltf(files: &dyn Files, path: &Path, options: &LoadOptions) -> Result<Scene, SceneError> {
    super::gltf::load(files, path, options)
}

#[cfg(not(feature = "gltf"))]
fn gltf(_: &dyn Files, path: &Path, _: &LoadOptions) -> Result<Scene, SceneError> {
    Err(SceneError::WithoutFeature { what: path.display().to_string(), feature: "gltf" })
}

/// Loads a scene from the bytes of a .gltf or .glb file. `name` is the file's name in errors and the scene's name;
/// files referred to are searched in the working directory.
///
/// # Errors
/// [`SceneError`].
#[cfg(feature = "gltf")]
pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Scene, SceneError> {
    super::gltf::from_bytes(name, bytes)
}
