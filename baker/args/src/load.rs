//! Arguments about the scene's file.

use crate::error::ArgsError;
use crate::number;
use crate::sky::SkyArgs;
use clap::Args;
use rebounce::io::{Files, GroupOption, LoadOptions, PoseOption, load_by_name, read_looks};
use rebounce::scene::{Scene, SceneError};
use rebounce_shared::rbn::groups::MAX_DENSITY;
use rebounce_shared::shot::Shot;
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
    /// The animation whose moment --time the scene is in, by its name or number; its first when absent
    #[arg(
        long,
        help_heading = "The scene's file",
        hide_short_help = true,
        value_name = "N|NAME",
        requires = "time"
    )]
    animation: Option<String>,
    /// Seconds: nodes, skins and morph targets stand as an animation has them then; at rest when absent. Of several files,
    /// those that have the animation
    #[arg(long, help_heading = "The scene's file", hide_short_help = true, value_name = "SECONDS", value_parser = number::at_least_zero)]
    time: Option<f64>,
    /// What animations deform, skins and morph targets, stands still, and the file is smaller; without it the file has their
    /// keyframes, and the viewer plays them
    #[arg(long, help_heading = "The scene's file", hide_short_help = true)]
    still: bool,
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
        let pose = self.time.map(|time| PoseOption { animation: self.animation.clone(), time });
        self.load_posed(files, spec, all_nodes_move, pose, note)
    }

    /// As [`Self::load`], with the pose of a shot, or that of the arguments.
    ///
    /// # Errors
    /// As [`Self::load`].
    pub fn load_for(
        &self,
        files: &dyn Files,
        spec: &str,
        shot: &Shot,
        note: &mut dyn FnMut(&str),
    ) -> Result<Scene, ArgsError> {
        let all_nodes_move = !shot.moves.is_empty();
        if !shot.is_animated() {
            return self.load(files, spec, all_nodes_move, note);
        }
        let pose = PoseOption { animation: shot.animation.clone(), time: shot.time.unwrap_or_default() };
        self.load_posed(files, spec, all_nodes_move, Some(pose), note)
    }

    fn load_posed(
        &self,
        files: &dyn Files,
        spec: &str,
        all_nodes_move: bool,
        pose: Option<PoseOption>,
        note: &mut dyn FnMut(&str),
    ) -> Result<Scene, ArgsError> {
        let options = LoadOptions {
            scene: self.choice.clone(),
            albedo: self.albedo,
            light_groups: self.light_group.clone(),
            groups: self.group.clone(),
            all_nodes_move,
            pose,
            is_still: self.still,
        };
        if self.at.len() > self.add.len() {
            return Err(ArgsError::Places { files: self.add.len(), places: self.at.len() });
        }
        // Files without the animation are at rest where another one has it.
        let mut lacking = None;
        let mut posed = 0;
        let mut load = |spec: &str, options: LoadOptions| {
            let is_posed = options.pose.is_some();
            match load_by_name(files, spec, &options) {
                Err(error @ SceneError::NoAnimation { .. }) if !self.add.is_empty() => {
                    lacking.get_or_insert(error);
                    load_by_name(files, spec, &LoadOptions { pose: None, ..options })
                }
                loaded => {
                    posed += usize::from(is_posed && loaded.is_ok());
                    loaded
                }
            }
        };
        let mut scene = load(spec, options.clone())?;
        for (number, spec) in self.add.iter().enumerate() {
            let options = LoadOptions { scene: None, ..options.clone() };
            let at = self.at.get(number).copied().unwrap_or_default();
            scene.add(load(spec, options)?, at.into())?;
        }
        if let Some(error) = lacking.filter(|_| posed == 0) {
            return Err(error.into());
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
