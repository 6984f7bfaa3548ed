//! `rebounce reference`: a scene path-traced by brute force.

use super::load::{note, warn};
use super::picture::{PictureArgs, Rows, shot_or_own};
use anyhow::Result;
use clap::Args;
use rebounce::bake::{BakeSettings, Preset, lights_and_cameras};
use rebounce::geometry::SceneSurfaces;
use rebounce::io::files::Disk;
use rebounce::light::illumination::Illumination;
use rebounce::scene::emissive_groups;
use rebounce::verify::path_trace::{Settings, path_trace};
use rebounce_args::load::LoadArgs;

/// Arguments of `rebounce reference`.
#[derive(Args, Debug)]
pub struct ReferenceArgs {
    /// A .gltf, .glb or .step file, or builtin:cornell-box, builtin:apartment, builtin:gallery, builtin:library,
    /// builtin:theatre, builtin:two-rooms-door, builtin:two-rooms, builtin:two-rooms-leaf, builtin:two-rooms-leaf-open,
    /// builtin:arcade, builtin:corridor, builtin:attic, builtin:maze, builtin:office, builtin:furnace, builtin:trophy, builtin:walker
    scene: String,
    #[command(flatten)]
    load: LoadArgs,
    #[command(flatten)]
    picture: PictureArgs,
    /// Samples per pixel
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..))]
    spp: u32,
    /// Bounces of light; all of them when absent
    #[arg(long)]
    bounces: Option<u32>,
}

/// Runs the command.
pub fn run(args: &ReferenceArgs) -> Result<()> {
    let shot = args.picture.prepare()?;
    let mut scene = match &shot {
        Some(shot) => args.load.load_for(&Disk, &args.scene, shot, &mut note)?,
        None => args.load.load(&Disk, &args.scene, false, &mut note)?,
    };
    warn(&scene);
    if let Some(shot) = shot.as_ref().filter(|shot| !shot.moves.is_empty()) {
        let motions = shot.motions(&scene.groups, scene.origin).map_err(anyhow::Error::msg)?;
        scene = scene.moved(&motions);
    }
    let shot = match shot {
        Some(shot) => shot,
        None => {
            if scene.cameras.is_empty() || scene.all_lights().0.is_empty() {
                eprintln!(
                    "note: the scene has no camera or no light; it is seen as a bake without --viewpoint shows it"
                );
            }
            let (lights, cameras) = lights_and_cameras(&scene, &BakeSettings::new(Preset::Standard))?;
            shot_or_own(None, &args.scene, &cameras, &lights)?
        }
    };
    let groups = emissive_groups(&scene);
    let names: Vec<String> = groups.iter().map(|group| group.name.clone()).collect();
    let (shot, environment) = args.picture.lit(shot, &names, scene.environment.clone())?;
    let surfaces = SceneSurfaces::from_scene(&scene);
    let illumination =
        Illumination::of_scene(&surfaces, &shot.lights, scene.origin, &groups, environment.as_ref());
    let exposure = args.picture.exposure(&shot, args.spp);
    let settings = Settings { only: args.picture.only(), bounces: args.bounces, gloss: shot.gloss };
    let rows = Rows::new(exposure.size[1]);
    let picture =
        path_trace(&surfaces, scene.origin, &shot.camera, &illumination, exposure, settings, || rows.done());
    rows.finish();
    let frame = shot.camera.frame(scene.origin);
    let lights: Vec<_> = shot.lights.iter().map(|light| light.source(scene.origin)).collect();
    args.picture.write(&picture, &surfaces, &frame, &lights, exposure, None)
}
