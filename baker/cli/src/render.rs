//! `rebounce render`: a baked file relit on the CPU.

use super::picture::{PictureArgs, Rows, shot_or_own};
use super::read_baked;
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::with_lights::WithLights;
use rebounce::sampling::cube_maps::CubeMapSettings;
use rebounce::verify::render::posed::PosedScene;
use rebounce::verify::render::reflections::cube_maps::{Correction, CubeMapLookup};
use rebounce::verify::render::reflections::{ReflectionView, Way};
use rebounce::verify::render::{Relit, packed_environment};
use rebounce_args::number;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::light::LightKind;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::rig::pose::Pose;
use rebounce_shared::shot::Shot;
use std::path::PathBuf;
use std::sync::Arc;

/// Most cube maps that are made for a picture.
const MOST_MAPS: usize = 256;

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
    /// What metals reflect, in a shot with gloss
    #[arg(long, value_enum, default_value = "baked")]
    reflections: ReflectionsArg,
    /// Number of cube maps that are made for the picture, and texels along an edge of their faces
    #[arg(long, value_name = "COUNTxSIDE", value_parser = |text: &str| number::cube_maps(text, MOST_MAPS), default_value = "16x32")]
    cube_maps: (usize, usize),
}

/// What metals reflect.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum ReflectionsArg {
    /// What is baked, as the page does: the file's cube maps, or its glossy transfer where it has none
    Baked,
    /// The file's glossy transfer
    Transfer,
    /// What rays find, one for each sample of a lobe
    Rays,
    /// Cube maps, corrected by depth
    CubeMaps,
    /// As cube-maps, and the transfer where no map is sure
    CubeMapsTransfer,
    /// Cube maps, corrected by the depth in the middle of each lobe
    CubeMapsMiddle,
    /// Cube maps, corrected by a box around each
    Boxes,
    /// Cube maps of what is taken to be far away
    Far,
    /// What rays in the picture find, and the transfer where they find nothing
    Screen,
    /// As screen, with cube maps corrected by depth in place of the transfer
    ScreenCubeMaps,
}

impl ReflectionsArg {
    fn way(self, (count, side): (usize, usize), view: ReflectionView) -> Way {
        let maps = CubeMapSettings { count, side, ..CubeMapSettings::default() };
        let by = |correction| Way::CubeMaps(maps, CubeMapLookup { correction, ..CubeMapLookup::default() });
        match self {
            Self::Baked => Way::Baked,
            Self::Transfer => Way::Transfer,
            Self::Rays => Way::Rays,
            Self::CubeMaps => by(Correction::Depth),
            Self::CubeMapsTransfer => {
                Way::CubeMaps(maps, CubeMapLookup { with_transfer: true, ..CubeMapLookup::default() })
            }
            Self::CubeMapsMiddle => by(Correction::MiddleDepth),
            Self::Boxes => by(Correction::Box),
            Self::Far => by(Correction::None),
            Self::Screen => Way::Screen(view, None),
            Self::ScreenCubeMaps => Way::Screen(view, Some(maps)),
        }
    }
}

/// Says what the reflections of a picture cost.
fn report(relit: &Relit) {
    let cost = relit.reflection_cost();
    if cost.samples > 0 {
        let each = |n: u64| n as f64 / cost.samples as f64;
        eprintln!(
            "reflections: {} lobes of {:.1} samples, {:.1} steps a sample, {:.1}% not sure",
            cost.lobes,
            cost.samples as f64 / cost.lobes as f64,
            each(cost.steps),
            100.0 * each(cost.fallbacks)
        );
    }
    if let Some(maps) = relit.cube_maps() {
        eprintln!("cube maps: {} texels, {} bytes before compression", maps.texels(), maps.bytes());
    }
}

/// The file with its rig as the shot's animation has it.
fn posed(scene: &BakedScene, shot: &Shot, name: &str) -> Result<Arc<PosedScene>> {
    let animations = &scene.rig.layout.animations;
    if animations.is_empty() {
        bail!(
            "{name} has nothing that an animation deforms, and is a scene as it was baked: bake the moment, \
             `rebounce bake SCENE --animation NAME --time SECONDS`, and leave animation and time out of the shot"
        );
    }
    let found = match &shot.animation {
        None => animations.first(),
        Some(wanted) => {
            let named = animations.iter().find(|animation| animation.name == *wanted);
            named.or_else(|| animations.get(wanted.parse::<usize>().ok()?))
        }
    };
    let Some(animation) = found else {
        let names: Vec<&str> = animations.iter().map(|animation| animation.name.as_str()).collect();
        let wanted = shot.animation.as_deref().unwrap_or_default();
        bail!("{name}: no animation {wanted:?} deforms a mesh; there are {}", names.join(", "));
    };
    let time = shot.time.unwrap_or_default() as f32;
    Ok(Arc::new(PosedScene::new(scene, &Pose::of(&scene.rig, animation, time))))
}

/// Runs the command.
pub fn run(args: &RenderArgs) -> Result<()> {
    let shot = args.picture.prepare()?;
    let (_, scene) = read_baked(&args.file)?;
    let name = args.file.display().to_string();
    let shot = shot_or_own(shot, &name, &scene.meta.cameras, &scene.meta.lights)?;
    let posed = shot.is_animated().then(|| posed(&scene, &shot, &name)).transpose()?;
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
    let drawn = posed.as_ref().map_or(&scene, |posed| &posed.scene);
    let surfaces = TriangleSurfaces::from_moved(drawn, &motions)?;
    let exposure = args.picture.exposure(&shot, args.spp);
    let rows = Rows::new(exposure.size[1]);
    let lighting = Lighting::new(&shot.lights, environment.as_ref(), scene.meta.origin, names.len());
    let lighting = lighting.with_groups(scene.solved_lights(), &shot.lights).with_context(|| name.clone())?;
    let lamps = lighting.lamps.clone();
    let with_lights = WithLights::new(&surfaces, &lamps);
    let relit = match posed {
        None => Relit::moved(&scene, &with_lights, lighting, !args.no_detail, &motions),
        Some(ref posed) => {
            let pose = (&motions, posed.clone());
            Relit::posed(&scene, &with_lights, lighting, !args.no_detail, pose)
        }
    };
    let frame = shot.camera.frame(scene.meta.origin);
    let relit = if shot.gloss {
        let view = ReflectionView { frame, size: exposure.size };
        relit.with_reflections(&scene, &with_lights, &args.reflections.way(args.cube_maps, view))
    } else {
        relit
    };
    let only = args.picture.only();
    let picture = relit.picture(&scene, &with_lights, &shot.camera, exposure, only, || rows.done());
    rows.finish();
    report(&relit);
    let ground = scene.meta.shown.ground().filter(|_| !args.no_backdrop);
    // The sky counts for the exposure.
    let skies = shot.lights.iter().filter(|light| light.kind() == LightKind::Environment);
    let mut lights = relit.lamps().to_vec();
    lights.extend(skies.map(|sky| sky.source(scene.meta.origin)));
    args.picture.write(&picture, &surfaces, &frame, &lights, exposure, ground.as_ref())
}
