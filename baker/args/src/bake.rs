//! The arguments of `rebounce bake`.

use crate::error::ArgsError;
use crate::layout::{
    ADVANCED, LayoutArgs, PresetName, PurposeName, RefinementName, SolverName, TransferName,
};
use crate::load::LoadArgs;
use crate::number;
use crate::paths::{Places, check_paths};
use clap::Args;
use rebounce::bake::{BakeSettings, Preset, budget};
use rebounce::io::{Files, shot};
use rebounce::sampling::cube_maps::CubeMapSettings;
use rebounce::scene::Scene;
use rebounce_shared::camera::Camera;
use rebounce_shared::interpolation::MAX_POINTS;
use rebounce_shared::rbn::cube_maps::MAX_MAPS;
use rebounce_shared::shot::Shot;
use std::path::{Path, PathBuf};

/// Maximum rays per receiver: over a second of work per receiver.
const MOST_RAYS: i64 = 1 << 20;
/// Ending of the file with the previews of a bake.
pub const PREVIEW: &str = "preview.rbn";
/// Headings of the help.
const QUALITY: &str = "Quality";

const AFTER_HELP: &str = "\
A bake keeps what it has done in FILE.rbn.partial beside its output. When it was stopped or killed, the same command with \
--resume goes on from there; the result is the same file, to the byte. It is removed when the bake is done. FILE.rbn itself \
is replaced only then, and at once.

Where it is built with the feature mpi, `mpirun -n 4 rebounce bake ...` shares the work among four processes; the result \
is the same file, to the byte, and --resume goes on with any number of them.

Exit codes: 0 done; 1 failed; 2 wrong arguments; 3 done, and the file is written, but its error is over --target-error; 4 done, and the file is written, but noise hides whether its error is over --target-error; 130 stopped by Ctrl-C, 143 by SIGTERM, --resume goes on.

--json-progress prints objects with stage, level (or null), done and total (units of this stage and level), rays_per_second \
(or null), seconds (since the bake began), seconds_left, processor_seconds and processor_seconds_left (of all threads together: they do \
not count what else the machine does), fraction (0 to 1); the last one has the stage \"done\" (with --target-error also measured_error, null where noise hides it, measured_error_at_least and measured_error_at_most), or \"failed\" and error, or \"stopped\" and checkpoint, the file to go on from. \
A signal ends the command at once, and without a last line, while it reads the scene.

--target-error bakes a draft, standard, fine, and then twice and four times as many functions, until one is within the error; progress goes from 0 to 1 \
for each. FILE.rbn always has the best one so far. Before, the view is path-traced, about half as long as a standard bake takes; where the noise of that hides whether the error is small enough, \
with ever more samples, up to 800 a pixel. An error that they hide too is \"too noisy to tell\", and finer bakes follow as for one that is over. \
--resume goes on with the bake that was stopped, and knows nothing of the errors before it. Several processes cannot do it.";

/// Arguments of `rebounce bake`. What is wanted every day comes first; the rest stands under headings in `--help`, and
/// not at all in `-h`.
#[derive(Args, Debug)]
#[command(after_help = "More options, and what each of them means: rebounce bake --help", after_long_help = AFTER_HELP)]
pub struct BakeArgs {
    /// A .gltf, .glb or .step file, or builtin:NAME
    ///
    /// The built-in scenes are builtin:cornell-box, builtin:apartment, builtin:gallery, builtin:library,
    /// builtin:theatre, builtin:two-rooms-door, builtin:two-rooms, builtin:two-rooms-leaf, builtin:two-rooms-leaf-open,
    /// builtin:arcade, builtin:corridor, builtin:attic, builtin:maze, builtin:office, builtin:furnace, builtin:trophy and builtin:walker.
    pub scene: String,
    /// Where to write; SCENE.rbn in the working folder when absent
    #[arg(short, long, value_name = "FILE.rbn")]
    pub output: Option<PathBuf>,
    /// How good and how costly
    #[arg(long, value_enum, default_value = "standard")]
    preset: PresetName,
    /// Bakes ever finer until the picture is within this error of a path tracer, as in 0.1
    ///
    /// The error of the bounced light is measured in the view of --shot, or of the scene's own camera and lights. Where
    /// there is neither, the coarsest preset that is made for the error is taken.
    #[arg(long, value_name = "ERROR", value_parser = number::over_zero, conflicts_with_all = ["preset", "functions", "coarse_radius", "levels"])]
    pub target_error: Option<f64>,
    /// What the file is shown in: a room with lamps, or an object under any environment
    ///
    /// An object has a small file: its points get the light of the environment, self-shadowed and after all bounces, and no
    /// links. Its metals reflect the environment. Lamps light it without a bounce, directional ones with.
    #[arg(long = "for", value_enum, default_value = "room", value_name = "PURPOSE")]
    purpose: PurposeName,
    /// What bounced light is computed from
    #[arg(long, value_enum, default_value = "operator", help_heading = QUALITY, hide_short_help = true)]
    solver: SolverName,
    /// How the links of the first bounce are found
    #[arg(long, value_enum, default_value = "gather", help_heading = QUALITY, hide_short_help = true)]
    refine: RefinementName,
    /// A camera to bake for, and the view of --target-error (docs/guide/shot.md)
    ///
    /// Points are placed for this camera besides the scene's own. --target-error is measured with its camera and lights,
    /// with the scene's own when absent.
    #[arg(long, value_name = "SHOT.json")]
    pub shot: Option<PathBuf>,
    /// A place within the room that matters, in the scene's units
    ///
    /// What is seen from there, and what lights that, gets functions, in large open scenes most near by. The option may be
    /// given several times. When absent, the cameras of the shot and the scene count; without any the place is found. A
    /// camera or lamp that is added to a scene without goes there, too.
    #[arg(long, value_name = "X,Y,Z", value_parser = number::place, allow_hyphen_values = true)]
    viewpoint: Vec<[f64; 3]>,
    /// Most bytes of the file, as in 8M
    ///
    /// The bake takes fewer functions, then fewer links.
    #[arg(long, value_name = "BYTES", value_parser = number::bytes)]
    pub max_bytes: Option<u64>,
    /// Writes FILE.preview.rbn early and ever finer, for `rebounce view --watch`
    #[arg(long)]
    pub preview: bool,
    /// Goes on with a bake that was stopped or killed: the same scene, settings and output
    #[arg(long)]
    pub resume: bool,

    /// How the scene is loaded.
    #[command(flatten)]
    pub load: LoadArgs,
    /// Leaves out the light of the sky and of shining surfaces, which are then only shown
    #[arg(long, help_heading = QUALITY, hide_short_help = true)]
    pub no_sources: bool,

    /// Roughness from which metals, and what is not metal, reflect like chalk: 0 for no gloss at all
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_name = "METALS[,OTHERS]", value_parser = number::one_or_two)]
    gloss_roughness: Option<(f32, Option<f32>)>,
    /// About how many functions the finest level has, as in 25K; the preset's when absent
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_parser = |text: &str| number::count(text, MAX_POINTS))]
    functions: Option<usize>,
    /// Rays per receiver, coarsest level first; the last number holds for finer levels
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=MOST_RAYS))]
    rays: Option<Vec<u32>>,
    /// Bounces of light; all that matter when absent
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_parser = clap::value_parser!(u32).range(1..))]
    pub bounces: Option<u32>,
    /// The weakest link that is kept, as a share of the light that the scene's surfaces reflect
    ///
    /// A link says how much light one part of a surface gives another. The light of a weaker link is added to a stronger one
    /// beside it, so that none is lost: a larger share makes a smaller file and coarser bounced light.
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_parser = number::at_least_zero_single)]
    epsilon: Option<f32>,
    /// The least certain link that is kept, in standard deviations of its own noise
    ///
    /// Links are measured with random rays. The light of a link that stands out less from its noise is added to a stronger one
    /// beside it: a larger number makes smoother bounced light with less detail.
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_parser = number::at_least_zero_single)]
    significance: Option<f32>,

    /// Most bytes of memory, about, as in 2G: the bake takes fewer functions
    #[arg(long, help_heading = "Limits", hide_short_help = true, value_name = "BYTES", value_parser = number::bytes)]
    pub max_memory: Option<u64>,
    /// Threads; all cores when absent
    #[arg(long, help_heading = "Limits", hide_short_help = true)]
    pub threads: Option<usize>,

    /// Prints progress as JSON, one object a line, on standard output, and no summary
    #[arg(long, help_heading = "Reports", hide_short_help = true)]
    pub json_progress: bool,
    /// Writes the figures of the closing summary as JSON
    #[arg(long, help_heading = "Reports", hide_short_help = true, value_name = "FILE.json")]
    pub report: Option<PathBuf>,

    /// Levels of senders, the coarsest ones
    #[arg(long, help_heading = ADVANCED, hide_short_help = true)]
    sender_levels: Option<usize>,
    /// Levels at whose points direct light is sampled
    #[arg(long, help_heading = ADVANCED, hide_short_help = true)]
    direct_levels: Option<usize>,
    /// Levels that light is gathered on to bounce again, the coarsest ones
    #[arg(long, help_heading = ADVANCED, hide_short_help = true)]
    later_levels: Option<usize>,
    /// How bounced light comes to metals
    #[arg(long, value_enum, help_heading = ADVANCED, hide_short_help = true)]
    gloss_transfer: Option<TransferName>,
    /// Cube maps that metals reflect, and texels along an edge of their faces; 0 for none
    #[arg(long, value_name = "COUNTxSIDE", help_heading = ADVANCED, hide_short_help = true, value_parser = |text: &str| number::cube_maps(text, MAX_MAPS))]
    cube_maps: Option<(usize, usize)>,
    #[command(flatten)]
    layout: LayoutArgs,
}

impl BakeArgs {
    /// Loads the scene. `note` receives sentences about what is worth knowing.
    ///
    /// # Errors
    /// The problem in the scene's file or in the environment.
    pub fn scene(&self, files: &dyn Files, note: &mut dyn FnMut(&str)) -> Result<Scene, ArgsError> {
        let all_nodes_move = self.solver == SolverName::Radiosity;
        let mut scene = self.load.load(files, &self.scene, all_nodes_move, note)?;
        scene.emission_is_shown_only = self.no_sources;
        Ok(scene)
    }

    /// Checks the paths before long work: the outputs can be written, and overwrite no input.
    ///
    /// # Errors
    /// The problem.
    pub fn check(&self, places: &dyn Places) -> Result<(), ArgsError> {
        if self.purpose == PurposeName::Environment {
            let other = [
                (self.solver == SolverName::Radiosity, "--solver radiosity"),
                (self.no_sources, "--no-sources"),
                (self.target_error.is_some(), "--target-error"),
                (self.gloss_transfer == Some(TransferName::Links), "--gloss-transfer links"),
                (self.cube_maps.is_some(), "--cube-maps"),
                (!self.viewpoint.is_empty(), "--viewpoint"),
            ];
            if let Some((_, option)) = other.into_iter().find(|(is_given, _)| *is_given) {
                return Err(ArgsError::ForEnvironment(option));
            }
        }
        check_paths(places, &self.scene, self.shot.as_deref(), &self.output(), self.report.as_deref())
    }

    /// Returns the preset of `--preset`, or the preset for `--target-error`.
    ///
    /// # Errors
    /// If no preset is made for the error.
    pub fn preset(&self) -> Result<Preset, ArgsError> {
        Ok(match (self.target_error, self.preset) {
            (Some(error), _) => budget::preset_for(error).map_err(ArgsError::Target)?,
            (None, preset) => preset.into(),
        })
    }

    /// Reads the shot of `--shot`.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn shot(&self, files: &dyn Files) -> Result<Option<Shot>, ArgsError> {
        Ok(self.shot.as_deref().map(|path| shot::read_from(files, path)).transpose()?)
    }

    /// Returns the preset's settings with the overrides of the arguments; points are placed for `camera`, too.
    pub fn settings(&self, preset: Preset, camera: Option<&Camera>) -> BakeSettings {
        let mut s = BakeSettings::new(preset);
        if self.purpose == PurposeName::Environment {
            s = s.for_environment();
        }
        fn set<T: Clone>(value: &mut T, given: &Option<T>) {
            if let Some(given) = given {
                *value = given.clone();
            }
        }
        s.solver = self.solver.into();
        s.operator.refinement = self.refine.into();
        s.viewpoints = self.viewpoint.clone();
        s.camera = camera.cloned();
        s.operator.bounces = self.bounces;
        set(&mut s.place.functions, &self.functions);
        set(&mut s.operator.sender_levels, &self.sender_levels);
        set(&mut s.operator.epsilon, &self.epsilon);
        set(&mut s.operator.significance, &self.significance);
        set(&mut s.operator.rays, &self.rays);
        set(&mut s.operator.later_levels, &self.later_levels);
        set(&mut s.direct_levels, &self.direct_levels);
        self.layout.apply(&mut s);
        if let (Some(gloss), Some(transfer)) = (&mut s.gloss, self.gloss_transfer) {
            gloss.transfer = transfer.into();
        }
        if let (Some(gloss), Some((count, side))) = (&mut s.gloss, self.cube_maps) {
            // Who names them has them, in the open too.
            gloss.cube_maps = CubeMapSettings { count, side, most_open: 1.0, ..gloss.cube_maps };
        }
        if let (Some(gloss), Some((metals, others))) = (&mut s.gloss, self.gloss_roughness) {
            gloss.metals = metals;
            gloss.dielectrics = others.unwrap_or(gloss.dielectrics.min(metals));
        }
        s.sources.sky = !self.no_sources;
        s
    }

    /// Path of the previews of `--preview`.
    pub fn preview_output(&self) -> Option<PathBuf> {
        self.preview.then(|| self.output().with_extension(PREVIEW))
    }

    /// Path of the output file.
    pub fn output(&self) -> PathBuf {
        output_of(&self.scene, self.output.as_deref())
    }
}

/// Returns the path of the baked file: the `given` one, or the scene's name with .rbn in the working folder.
pub fn output_of(scene: &str, given: Option<&Path>) -> PathBuf {
    let name = || PathBuf::from(scene.rsplit([':', '/', '\\']).next().unwrap_or("scene"));
    given.map_or_else(|| name().with_extension("rbn"), Path::to_owned)
}
