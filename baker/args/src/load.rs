//! Arguments about the scene's file.

use crate::error::ArgsError;
use crate::number;
use crate::sky::SkyArgs;
use clap::Args;
use rebounce::io::{Files, GroupOption, LoadOptions, load_by_name, read_looks};
use rebounce::scene::Scene;
use rebounce_shared::rbn::groups::MAX_DENSITY;
use std::path::PathBuf;

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
    /// Looks of parts or materials by their names (docs/guide/step.md): color, roughness, metallic, emission
    #[arg(long, help_heading = "The scene's file", hide_short_help = true, value_name = "FILE.json")]
    materials: Option<PathBuf>,
    /// Puts another file, .glb, .gltf or .step, into the scene; may be given several times
    #[arg(long, help_heading = "The scene's file", hide_short_help = true, value_name = "FILE")]
    add: Vec<String>,
    /// Where the origin of what --add names is put, once for each, in its order; the scene's origin when absent
    #[arg(long, help_heading = "The scene's file", hide_short_help = true, value_name = "X,Y,Z", requires = "add", value_parser = number::place, allow_hyphen_values = true)]
    at: Vec<[f64; 3]>,
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
        if self.at.len() > self.add.len() {
            return Err(ArgsError::Places { files: self.add.len(), places: self.at.len() });
        }
        let mut scene = load_by_name(files, spec, &options)?;
        for (number, spec) in self.add.iter().enumerate() {
            let options = LoadOptions { scene: None, ..options.clone() };
            let at = self.at.get(number).copied().unwrap_or_default();
            scene.add(load_by_name(files, spec, &options)?, at.into())?;
        }
        if let Some(path) = &self.materials {
            for name in scene.apply_looks(&read_looks(files, path)?) {
                scene.notes.push(format!("{}: no part and no material is named {name:?}", path.display()));
            }
        }
        self.sky.add_to(&mut scene, files, note)?;
        Ok(scene)
    }
}

/// Returns warnings about omissions and changes made while loading a scene's file, a sentence each.
pub fn warnings(scene: &Scene) -> Vec<String> {
    let left_out = scene.left_out.iter().map(|problem| format!("left out: {problem}"));
    left_out.chain(scene.notes.iter().cloned()).collect()
}
