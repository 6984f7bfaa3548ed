//! `rebounce render`: a baked file relit on the CPU.

use super::picture::{PictureArgs, Rows, shot_or_own};
use super::read_baked;
use anyhow::{Context, Result};
use clap::Args;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::with_lights::WithLights;
use rebounce::verify::render::{Relit, packed_environment};
use rebounce_shared::light::LightKind;
use rebounce_shared::lighting::Lighting;
use std::path::PathBuf;

/// Arguments of `rebounce render`.
#[derive(Args, Debug)]
pub struct RenderArgs {
    /// A baked scene
    #[arg(value_name = "FILE.rbn")]
    file: PathBuf,
    #[command(flatten)]
    picture: PictureArgs,
    /// Samples per pixel
    #[arg(long, default_value_t = 64, value_parser = clap::value_parser!(u32).range(1..))]
    spp: u32,
    /// Leaves out the grey behind an object and its shadow on the ground, in a PNG
    #[arg(long)]
    no_backdrop: bool,
    /// Leaves out detail finer than the functions: bounced light is interpolated between the points alone
    #[arg(long)]
    no_detail: bool,
}

/// Runs the command.
pub fn run(args: &RenderArgs) -> Result<()> {
    let shot = args.picture.prepare()?;
    let (_, scene) = read_baked(&args.file)?;
    let name = args.file.display().to_string();
    let shot = shot_or_own(shot, &name, &scene.meta.cameras, &scene.meta.lights)?;
    let names: Vec<String> = scene.sources.groups.iter().map(|group| group.name.clone()).collect();
    let own = packed_environment(&scene);
    let (shot, environment) = match scene.is_solved() {
        true => (args.picture.lit_as_solved(shot, &names)?, own),
        false => args.picture.lit(shot, &names, own)?,
    };
    let motions = shot
        .motions(&scene.groups, scene.meta.origin)
        .map_err(anyhow::Error::msg)
        .with_context(|| name.clone())?;
    let surfaces = TriangleSurfaces::from_moved(&scene, &motions)?;
    let exposure = args.picture.exposure(&shot, args.spp);
    let rows = Rows::new(exposure.size[1]);
    let lighting = Lighting::new(&shot.lights, environment.as_ref(), scene.meta.origin, names.len());
    let lighting = lighting.with_groups(scene.solved_lights(), &shot.lights).with_context(|| name.clone())?;
    let lamps = lighting.lamps.clone();
    let with_lights = WithLights::new(&surfaces, &lamps);
    let relit = Relit::moved(&scene, &with_lights, lighting, !args.no_detail, &motions);
    let relit = if shot.gloss { relit.with_gloss(&scene) } else { relit };
    let only = args.picture.only();
    let picture = relit.picture(&scene, &with_lights, &shot.camera, exposure, only, || rows.done());
    rows.finish();
    let frame = shot.camera.frame(scene.meta.origin);
    let ground = scene.meta.shown.ground().filter(|_| !args.no_backdrop);
    // The sky counts for the exposure.
    let skies = shot.lights.iter().filter(|light| light.kind() == LightKind::Environment);
    let mut lights = relit.lamps().to_vec();
    lights.extend(skies.map(|sky| sky.source(scene.meta.origin)));
    args.picture.write(&picture, &surfaces, &frame, &lights, exposure, ground.as_ref())
}
