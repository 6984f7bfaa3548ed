//! A scene and a shot in the viewer's renderer, without a window.

#[path = "../../../viewer/tests/common/screen.rs"]
pub mod screen;

use anyhow::{Context, Result};
use rebounce::io::{environment, shot};
use rebounce::shared::baked::BakedScene;
use rebounce::shared::environment::PackedEnvironment;
use rebounce::shared::light::Light;
use rebounce::shared::lighting::with_emission;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::renderer::Renderer;
use rebounce_viewer::scene::GpuScene;
use std::path::Path;

/// Uploads a .rbn file.
///
/// # Errors
/// If the file cannot be read, or the device refuses it.
pub fn open(gpu: &Gpu, file: &Path) -> Result<Renderer> {
    let mut renderer = Renderer::new(gpu.clone())?;
    let bytes = std::fs::read(file).with_context(|| file.display().to_string())?;
    let scene = BakedScene::from_bytes(&bytes).with_context(|| file.display().to_string())?;
    let loaded = pollster::block_on(GpuScene::upload(gpu, renderer.pipelines().loaders(), scene))?;
    renderer.install(loaded)?;
    Ok(renderer)
}

/// Takes camera, lights, mix, environment and motions of a SHOT.json; returns the shot's size.
///
/// # Errors
/// If the shot or its environment cannot be read, or the scene cannot show it.
pub fn set_shot(renderer: &mut Renderer, file: &Path) -> Result<[u32; 2]> {
    let mut shot = shot::read(file)?;
    let groups: Vec<String> = renderer
        .scene()
        .map_or_else(Vec::new, |scene| scene.sources.groups.iter().map(|group| group.name.clone()).collect());
    shot.resolve_groups(&groups).map_err(anyhow::Error::msg)?;
    let picture = shot.lights.iter().find_map(|light| match light {
        Light::Environment { file, .. } => file.as_deref(),
        _ => None,
    });
    if let Some(picture) = picture {
        let (picture, _) = environment::read(&file.with_file_name(picture))?;
        renderer.set_environment(Some(PackedEnvironment::whole(&picture)))?;
    }
    renderer.set_conductors(shot.gloss);
    renderer.set_lights(with_emission(&shot.lights, groups.len(), shot.emission))?;
    if shot.is_animated() {
        let animations = renderer.rig_animations();
        let number = shot.animation.as_ref().map_or(Some(0), |name| {
            animations.iter().position(|own| own.name == *name).or_else(|| name.parse().ok())
        });
        renderer.pose(number, shot.time.unwrap_or_default())?;
    }
    renderer.set_camera(shot.camera)?;
    renderer.set_mix(shot.mix)?;
    if !shot.moves.is_empty() {
        renderer.move_named(&shot.moves)?;
    }
    Ok(shot.size)
}
