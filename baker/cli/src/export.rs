//! `rebounce export`: the light of a baked file as a .glb file for other engines.

use super::picture::{OnlyArg, Rows, lit, set_threads, shot_or_own};
use super::read_baked;
use anyhow::{Context, Result, bail};
use clap::Args;
use rebounce::export::unwrap::Density;
use rebounce::export::{Export, ExportSettings, Form, export};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::with_lights::WithLights;
use rebounce::io::picture::Only;
use rebounce::io::shot;
use rebounce::io::write::{check_place, write_whole};
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::shown::Shown;
use rebounce::verify::render::{Relit, packed_environment};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::shot::Shot;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Texels on a metre when nothing is said, if they fit.
const TEXELS_PER_METRE: f32 = 20.0;
/// Greatest size of a texture that can be asked for, texels along a side.
const MOST: i64 = 8192;
/// Height and samples of the picture by which the exposure is measured, as many pixels as are looked at.
const LOOK: (u32, u32) = (64, 16);

/// Arguments of `rebounce export`.
#[derive(Args, Debug)]
pub struct ExportArgs {
    /// A baked scene
    #[arg(value_name = "FILE.rbn")]
    file: PathBuf,
    /// Lights, and the camera of the exposure (docs/guide/shot.md); the file's own when absent
    #[arg(long, value_name = "SHOT.json")]
    shot: Option<PathBuf>,
    /// Where to write
    #[arg(short, long, value_name = "OUT.glb")]
    output: PathBuf,
    /// Keeps the materials, and writes the light beside as OUT.exr: linear irradiance, for an engine's own lightmap
    #[arg(long)]
    lightmap_texture: bool,
    /// Gives light to vertices in place of a texture, for finely divided meshes
    #[arg(long, alias = "vertex-colors", conflicts_with_all = ["lightmap_texture", "texels_per_metre", "max_size"])]
    vertex_colours: bool,
    /// Texels of the texture along a metre; 20 when absent, or as many as fit
    #[arg(long, value_name = "N", value_parser = parse_positive)]
    texels_per_metre: Option<f32>,
    /// Greatest width and height of the texture, texels
    #[arg(long, value_name = "N", default_value_t = 2048, value_parser = clap::value_parser!(u32).range(64..=MOST))]
    max_size: u32,
    /// Unwraps the scene although the file has a lightmap, as those of `solve --solver wavelet` have
    #[arg(long, conflicts_with = "vertex_colours")]
    unwrap: bool,
    /// Factor of radiance before tone mapping; that of the shot's picture when absent
    #[arg(long, value_name = "FACTOR", conflicts_with = "lightmap_texture", value_parser = parse_positive)]
    exposure: Option<f32>,
    /// Which light to take
    #[arg(long, value_enum, default_value = "all")]
    only: OnlyArg,
    /// Samples per texel; with --vertex-colours, the least per triangle
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=4096))]
    spp: u32,
    /// Leaves out detail finer than the functions: bounced light is interpolated between the points alone
    #[arg(long)]
    no_detail: bool,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads; all cores when absent
    #[arg(long)]
    threads: Option<usize>,
}

fn parse_positive(text: &str) -> Result<f32, String> {
    let number = text.trim().parse::<f32>().ok();
    number
        .filter(|number| (1e-6..=1e12).contains(number))
        .ok_or_else(|| "give a number over zero, as in 20 or 0.5".to_owned())
}

/// Runs the command.
pub fn run(args: &ExportArgs) -> Result<()> {
    let is_glb = args.output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb"));
    if !is_glb {
        bail!("{}: what is written is a .glb file, its name must end in .glb", args.output.display());
    }
    check_place(&args.output)?;
    let beside = args.output.with_extension("exr");
    if args.lightmap_texture {
        check_place(&beside)?;
    }
    set_threads(args.threads)?;
    let shot = args.shot.as_deref().map(shot::read).transpose()?;
    let (_, scene) = read_baked(&args.file)?;
    let name = args.file.display().to_string();
    let shot = shot_or_own(shot, &name, &scene.meta.cameras, &scene.meta.lights)?;
    let names: Vec<String> = scene.sources.groups.iter().map(|group| group.name.clone()).collect();
    let (shot, environment) = lit(args.shot.as_deref(), shot, &names, packed_environment(&scene))?;
    let surfaces = TriangleSurfaces::from_baked(&scene)?;
    let lighting = Lighting::new(&shot.lights, environment.as_ref(), scene.meta.origin, names.len());
    let lighting = lighting.with_groups(scene.solved_lights(), &shot.lights).with_context(|| name.clone())?;
    let lamps = lighting.lamps.clone();
    let with_lights = WithLights::new(&surfaces, &lamps);
    let relit = Relit::lit(&scene, &with_lights, lighting, !args.no_detail);
    let form = match (args.lightmap_texture, args.vertex_colours) {
        (true, _) => Form::LightmapTexture,
        (_, true) => Form::VertexColours,
        _ => Form::Unlit,
    };
    let exposure = match (form, args.exposure) {
        (Form::LightmapTexture, _) => 1.0,
        (_, Some(exposure)) => exposure,
        _ => measured(&scene, &surfaces, &with_lights, &relit, &shot, args),
    };
    let settings = ExportSettings {
        form,
        density: match args.texels_per_metre {
            Some(density) => Density::Exactly(density),
            None => Density::AtMost(TEXELS_PER_METRE),
        },
        max_size: args.max_size,
        is_unwrapped: args.unwrap,
        samples: args.spp,
        seed: args.seed,
        only: args.only.into(),
        exposure,
    };
    let rows = OnceLock::new();
    let done = |total: u32| rows.get_or_init(|| Rows::new(total)).done();
    let made = export(&scene, (&surfaces, &with_lights), &relit, Some(&shot.camera), &settings, done)?;
    drop(rows);
    tell(&made, &settings);
    if let Some(lightmap) = &made.lightmap {
        lightmap.write(&beside, f32::INFINITY)?;
        eprintln!("wrote {}: irradiance, row 0 at v = 0 of TEXCOORD_1", beside.display());
    }
    write_whole(&args.output, &made.glb)?;
    eprintln!("wrote {} ({} bytes)", args.output.display(), made.glb.len());
    if form == Form::Unlit {
        tell_of_textures(&scene, &args.output);
    }
    Ok(())
}

/// Measures the exposure of the shot's picture.
fn measured(
    scene: &BakedScene,
    surfaces: &TriangleSurfaces,
    with_lights: &WithLights<TriangleSurfaces>,
    relit: &Relit,
    shot: &Shot,
    args: &ExportArgs,
) -> f32 {
    let only: Only = args.only.into();
    let (height, samples) = LOOK;
    let width = (u64::from(height) * u64::from(shot.size[0])).div_ceil(u64::from(shot.size[1].max(1)));
    let size = [width.clamp(1, 8 * u64::from(height)) as u32, height];
    let exposure = Exposure { size, samples, seed: args.seed };
    let picture = relit.picture(scene, with_lights, &shot.camera, exposure, only, || ());
    let camera = &shot.camera.frame(scene.meta.origin);
    Shown { surfaces, camera, lights: relit.lamps(), exposure, only, ground: None }.exposure_factor(&picture)
}

/// Says what the file holds.
fn tell(made: &Export, settings: &ExportSettings) {
    if let Some(atlas) = &made.atlas {
        let ([width, height], density) = (atlas.size, atlas.texels_per_unit);
        let (charts, used) = (atlas.charts, 100.0 * atlas.used);
        let origin = if atlas.is_own { ", those of the file's lightmap" } else { "" };
        eprintln!(
            "a texture of {width} x {height}: {density:.3} texels a metre, {charts} charts{origin}, {used:.0}% used"
        );
        if let Some(wanted) = atlas.wanted {
            let most = settings.max_size;
            eprintln!("note: {wanted} texels a metre do not fit {most} x {most}; --max-size allows more");
        }
    }
    if settings.form != Form::LightmapTexture {
        eprintln!("exposed by {:.6}, and tone mapped as pictures are", settings.exposure);
    }
}

/// Says that textures have become as coarse as the light.
fn tell_of_textures(scene: &BakedScene, output: &Path) {
    let textured = scene.meta.materials.iter().filter(|material| material.base_color_texture.is_some());
    let count = textured.filter(|material| !material.extras.unlit).count();
    if count > 0 {
        eprintln!(
            "note: the textures of {count} materials are in {} with the texels of the light; --lightmap-texture and \
             --vertex-colours keep them sharp",
            output.display()
        );
    }
}
