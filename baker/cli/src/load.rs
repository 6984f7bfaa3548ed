//! Loading of scene files, for the subcommands that read a scene.

use super::escape::escape_controls;
use super::number;
use super::sky::SkyArgs;
use anyhow::Result;
use clap::Args;
use rebounce::io::{LoadOptions, load_with};
use rebounce::scene::Scene;

/// Arguments about the scene's file.
#[derive(Args, Debug)]
pub struct LoadArgs {
    /// The scene of the glTF file, by its name or number, where there are several; its default when absent
    #[arg(long = "scene", help_heading = "The scene's file", hide_short_help = true, value_name = "N|NAME")]
    choice: Option<String>,
    /// What meshes without a material reflect, from 0 to 1, as in 0.8 or 0.8,0.7,0.6 (linear red, green, blue); all light
    /// when absent, as glTF has it
    #[arg(long, help_heading = "The scene's file", hide_short_help = true, value_name = "ALBEDO", value_parser = number::albedo)]
    albedo: Option<[f32; 3]>,
    /// What shines at and below the nodes of this name is a light of its own, apart from other surfaces of its material;
    /// may be given several times
    #[arg(long, help_heading = "The scene's file", hide_short_help = true, value_name = "NODE")]
    light_group: Vec<String>,
    #[command(flatten)]
    sky: SkyArgs,
}

impl LoadArgs {
    /// Loads a scene.
    ///
    /// # Errors
    /// The problem in the scene's file.
    pub fn load(&self, spec: &str) -> Result<Scene> {
        let options = LoadOptions {
            scene: self.choice.clone(),
            albedo: self.albedo,
            light_groups: self.light_group.clone(),
        };
        let mut scene = load_with(spec, &options)?;
        self.sky.add_to(&mut scene)?;
        Ok(scene)
    }
}

/// Prints warnings about omissions and changes made while loading a scene's file.
pub fn warn(scene: &Scene) {
    for problem in &scene.left_out {
        eprintln!("warning: left out: {}", escape_controls(problem));
    }
    for note in &scene.notes {
        eprintln!("warning: {}", escape_controls(note));
    }
}
