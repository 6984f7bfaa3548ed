//! Arguments about the scene's file.

use crate::error::ArgsError;
use crate::number;
use crate::sky::SkyArgs;
use clap::Args;
use rebounce::io::{Files, LoadOptions, load_by_name};
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
    /// Loads a scene. `note` receives sentences about what is worth knowing of the environment's picture.
    ///
    /// # Errors
    /// The problem in the scene's file or in the environment.
    pub fn load(
        &self,
        files: &dyn Files,
        spec: &str,
        note: &mut dyn FnMut(&str),
    ) -> Result<Scene, ArgsError> {
        let options = LoadOptions {
            scene: self.choice.clone(),
            albedo: self.albedo,
            light_groups: self.light_group.clone(),
        };
        let mut scene = load_by_name(files, spec, &options)?;
        self.sky.add_to(&mut scene, files, note)?;
        Ok(scene)
    }
}

/// Returns warnings about omissions and changes made while loading a scene's file, a sentence each.
pub fn warnings(scene: &Scene) -> Vec<String> {
    let left_out = scene.left_out.iter().map(|problem| format!("left out: {problem}"));
    left_out.chain(scene.notes.iter().cloned()).collect()
}
