//! Arguments about the scene's file.

use crate::error::ArgsError;
use crate::number;
use crate::sky::SkyArgs;
use clap::Args;
use rebounce::io::{Files, GroupOption, LoadOptions, load_by_name};
use rebounce::scene::Scene;
use rebounce_shared::rbn::groups::MAX_DENSITY;

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
    /// What is at and below the nodes of this name, or the surfaces of this material, are a reconstruction group: functions of
    /// their own, as dense as others, or so many times denser, as in statue=4; may be given several times
    #[arg(long, help_heading = "The scene's file", hide_short_help = true, value_name = "NAME[=DENSITY]", value_parser = group)]
    group: Vec<GroupOption>,
    #[command(flatten)]
    sky: SkyArgs,
}

/// Parses a group: a name, and a density after an equals sign.
fn group(text: &str) -> Result<GroupOption, String> {
    let wanted = || {
        format!("NAME or NAME=DENSITY is needed, the density from {} to {MAX_DENSITY}", MAX_DENSITY.recip())
    };
    let (name, density) = match text.rsplit_once('=') {
        Some((name, density)) => (name, density.trim().parse().map_err(|_| wanted())?),
        None => (text, 1.0),
    };
    let is_sound = !name.is_empty() && (MAX_DENSITY.recip()..=MAX_DENSITY).contains(&density);
    is_sound.then(|| GroupOption { name: name.to_owned(), density }).ok_or_else(wanted)
}

impl LoadArgs {
    /// Loads a scene; with `all_nodes_move` every node with a mesh is a reconstruction group. `note` receives sentences about
    /// what is worth knowing of the environment's picture.
    ///
    /// # Errors
    /// The problem in the scene's file or in the environment.
    pub fn load(
        &self,
        files: &dyn Files,
        spec: &str,
        all_nodes_move: bool,
        note: &mut dyn FnMut(&str),
    ) -> Result<Scene, ArgsError> {
        let options = LoadOptions {
            scene: self.choice.clone(),
            albedo: self.albedo,
            light_groups: self.light_group.clone(),
            groups: self.group.clone(),
            all_nodes_move,
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
