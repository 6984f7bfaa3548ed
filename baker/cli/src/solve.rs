//! `rebounce solve`: a scene and its lights in, a .rbn file whose lights stay in place out.

use super::load::{note, warn};
use super::picture::{read_environment, set_threads};
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use rebounce::bake::{BakeSettings, FixedSolver, SolveReport, SolveSettings, solve};
use rebounce::io::files::Disk;
use rebounce::io::shot;
use rebounce::io::write::write_whole;
use rebounce::scene::{Scene, emissive_groups};
use rebounce::transport::antiradiance::AntiradianceSettings;
use rebounce::transport::radiosity::RadiositySettings;
use rebounce::transport::wavelet::{Order, WaveletSettings};
use rebounce_args::bake::output_of;
use rebounce_args::layout::{LayoutArgs, PresetName};
use rebounce_args::load::LoadArgs;
use rebounce_args::number;
use rebounce_args::paths::{DiskPlaces, check_paths};
use rebounce_shared::antiradiance::bins::{LEAST_BINS, MOST_BINS};
use rebounce_shared::antiradiance::{Iteration, SolverSettings, Spreading};
use rebounce_shared::camera::Camera;
use rebounce_shared::interpolation::MAX_POINTS;
use rebounce_shared::light::{Light, LightKind};
use rebounce_shared::rbn::container;
use std::path::{Path, PathBuf};

/// Most rays per receiver.
const MOST_RAYS: i64 = 1 << 20;
/// Most patches and clusters.
const MOST_ELEMENTS: usize = 1 << 21;
/// Headings of the help.
const QUALITY: &str = "Quality";
const WAVELET: &str = "Wavelet radiosity";
const ANTIRADIANCE: &str = "Antiradiance";
const REPORTS: &str = "Reports";

const AFTER_HELP: &str = "\
The lights of the file stay where they are; each can be dimmed, switched off and coloured afterwards. They are those of \
--shot, or the scene's own. `rebounce bake` takes several times as long and makes files whose lights move.";

/// Arguments of `rebounce solve`.
#[derive(Args, Debug)]
#[command(after_help = AFTER_HELP)]
pub struct SolveArgs {
    /// A .gltf, .glb or .step file, or builtin:NAME
    scene: String,
    /// Where to write; SCENE.rbn in the working folder when absent
    #[arg(short, long, value_name = "FILE.rbn")]
    output: Option<PathBuf>,
    /// How many functions, as for `bake`
    #[arg(long, value_enum, default_value = "standard")]
    preset: PresetName,
    /// The lights to solve for, and a camera to place functions for (docs/guide/shot.md)
    #[arg(long, value_name = "SHOT.json")]
    shot: Option<PathBuf>,
    /// A place within the room that matters, in the scene's units
    #[arg(long, value_name = "X,Y,Z", value_parser = number::place, allow_hyphen_values = true)]
    viewpoint: Vec<[f64; 3]>,
    #[command(flatten)]
    load: LoadArgs,
    /// What computes the light: radiosity gathers at the functions; wavelet shoots between faces, exact ones of a .step file; antiradiance needs no visibility between patches of opaque surfaces
    #[arg(long, value_enum, default_value = "radiosity")]
    solver: SolverName,
    /// Order of the wavelets: 1 constant, 2 linear, 3 quadratic on each cell
    #[arg(long, help_heading = WAVELET, hide_short_help = true, default_value_t = 2, value_parser = clap::value_parser!(u8).range(1..=3))]
    order: u8,
    /// Share of the power that is shot before it ends
    #[arg(long, help_heading = WAVELET, hide_short_help = true, default_value_t = WaveletSettings::default().convergence, value_parser = convergence)]
    convergence: f64,
    /// Error of irradiance that divides a cell, as a share of what a shot gives on average
    #[arg(long, help_heading = WAVELET, hide_short_help = true, default_value_t = WaveletSettings::default().epsilon, value_parser = number::over_zero)]
    tolerance: f64,
    /// Most times that a face is divided in four
    #[arg(long, help_heading = WAVELET, hide_short_help = true, default_value_t = WaveletSettings::default().max_level, value_parser = clap::value_parser!(u32).range(0..=10))]
    depth: u32,
    /// About how many bins of directions, 64 to 1024
    #[arg(long, help_heading = ANTIRADIANCE, hide_short_help = true, default_value_t = SolverSettings::default().bins, value_parser = bins)]
    bins: usize,
    /// About how many patches and clusters, as in 45K
    #[arg(long, help_heading = ANTIRADIANCE, hide_short_help = true, value_parser = |text: &str| number::count(text, MOST_ELEMENTS))]
    elements: Option<usize>,
    /// Steps of the iteration at most; it ends when the light changes no more
    #[arg(long, help_heading = ANTIRADIANCE, hide_short_help = true, default_value_t = SolverSettings::default().iterations, value_parser = clap::value_parser!(u32).range(1..))]
    iterations: u32,
    /// Change of the light between two steps that ends the iteration, as a share of it; 0 takes all steps
    #[arg(long, help_heading = ANTIRADIANCE, hide_short_help = true, default_value_t = SolverSettings::default().tolerance, value_parser = number::at_least_zero_single)]
    change: f32,
    /// Order of the steps of radiance and antiradiance
    #[arg(long, help_heading = ANTIRADIANCE, hide_short_help = true, value_enum, default_value = "ordered")]
    iteration: IterationName,
    /// Steps of antiradiance for each one of radiance of the asymmetric iteration
    #[arg(long, help_heading = ANTIRADIANCE, hide_short_help = true, value_name = "STEPS", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..1000))]
    antiradiance_steps: u32,
    /// How light comes from senders that are wider than a bin
    #[arg(long, help_heading = ANTIRADIANCE, hide_short_help = true, value_enum, default_value = "exact")]
    spreading: SpreadingName,
    /// Greatest solid angle of the elements of a link, in bins
    #[arg(long, help_heading = ANTIRADIANCE, hide_short_help = true, default_value_t = SolverSettings::default().width, value_parser = number::over_zero_single)]
    link_width: f32,
    /// Metals throw light by a lobe, as GGX conductors; all is matt without
    #[arg(long, help_heading = ANTIRADIANCE, hide_short_help = true)]
    gloss: bool,
    /// About how many functions the finest level has, as in 25K; the preset's when absent
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_parser = |text: &str| number::count(text, MAX_POINTS))]
    functions: Option<usize>,
    /// Rays per receiver, coarsest level first; the last number holds for finer levels
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_delimiter = ',', value_parser = clap::value_parser!(u32).range(1..=MOST_RAYS))]
    rays: Option<Vec<u32>>,
    /// Bounces of light; all that matter when absent
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_parser = clap::value_parser!(u32).range(1..))]
    bounces: Option<u32>,
    /// Variation of light that refines a function, as a share of the mean bounced light
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_parser = number::over_zero_single)]
    epsilon: Option<f32>,
    /// Largest solid angle of a function that light leaves from, steradian
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_parser = number::over_zero_single)]
    sender_angle: Option<f32>,
    /// The least certain light that is kept, in standard deviations of its own noise
    #[arg(long, help_heading = QUALITY, hide_short_help = true, value_parser = number::at_least_zero_single)]
    significance: Option<f32>,
    /// Threads; all cores when absent
    #[arg(long, help_heading = "Limits", hide_short_help = true)]
    threads: Option<usize>,
    /// Writes the figures of the closing summary as JSON
    #[arg(long, help_heading = REPORTS, hide_short_help = true, value_name = "FILE.json")]
    report: Option<PathBuf>,
    #[command(flatten)]
    layout: LayoutArgs,
}

/// A solver of fixed lights.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum SolverName {
    Radiosity,
    Wavelet,
    Antiradiance,
}

/// An order of the steps of antiradiance.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum IterationName {
    /// Each bin from one end of the scene to the other: converges like light that bounces
    Ordered,
    /// Both in each step, of all elements at once, as a GPU does: may diverge between many surfaces behind each other
    Symmetric,
    /// Some of antiradiance, then one of both
    Asymmetric,
}

/// A way of spreading.
#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
enum SpreadingName {
    /// Each bin that the sender reaches gives its own light
    Exact,
    /// The bin of the middle gives its light to its neighbours too
    Gaussian,
}

fn bins(text: &str) -> Result<usize, String> {
    let count: usize = text.parse().map_err(|_| "a whole number is needed, as in 512".to_owned())?;
    if (LEAST_BINS..=MOST_BINS).contains(&count) {
        Ok(count)
    } else {
        Err(format!("it is from {LEAST_BINS} to {MOST_BINS}"))
    }
}

fn convergence(text: &str) -> Result<f64, String> {
    let share: f64 = text.parse().map_err(|_| "a number below 1 is needed, as in 0.99".to_owned())?;
    if (0.0..1.0).contains(&share) {
        Ok(share)
    } else {
        Err("it is from 0 to less than 1, as in 0.99".to_owned())
    }
}

/// Runs the command.
pub fn run(args: &SolveArgs) -> Result<()> {
    if args.solver == SolverName::Antiradiance
        && args.iteration == IterationName::Ordered
        && args.spreading == SpreadingName::Gaussian
    {
        bail!(
            "--spreading gaussian goes from bin to bin, and --iteration ordered sweeps each bin by itself: add \
             --iteration symmetric, or leave --spreading out"
        );
    }
    let output = output_of(&args.scene, args.output.as_deref());
    check_paths(&DiskPlaces, &args.scene, args.shot.as_deref(), &output, args.report.as_deref())?;
    set_threads(args.threads)?;
    let mut scene = args.load.load(&Disk, &args.scene, false, &mut note)?;
    warn(&scene);
    let mut settings = args.settings();
    if let Some(path) = &args.shot {
        settings.bake.camera = Some(light_by(&mut scene, path)?);
    }
    let (file, mut report) = solve(&scene, &settings).with_context(|| args.scene.clone())?;
    let bytes = file.to_bytes().with_context(|| args.scene.clone())?;
    write_whole(&output, &bytes)?;
    report.add_file(&container::read(&bytes)?, bytes.len() as u64);
    if let Some(path) = &args.report {
        write_report(path, &report)
            .with_context(|| format!("{} is written, its report is not", output.display()))?;
    }
    println!("{report}");
    println!("wrote         {}", output.display());
    Ok(())
}

fn write_report(path: &Path, report: &SolveReport) -> Result<()> {
    Ok(write_whole(path, &serde_json::to_vec_pretty(report)?)?)
}

/// Replaces the lights of a scene by those of a shot, and returns the shot's camera. Emissive surfaces keep a group each.
fn light_by(scene: &mut Scene, path: &Path) -> Result<Camera> {
    let mut shot = shot::read(path)?;
    let names: Vec<String> = emissive_groups(scene).iter().map(|group| group.name.clone()).collect();
    shot.resolve_groups(&names).map_err(anyhow::Error::msg)?;
    if !shot.mix.is_empty() || shot.emission != 1.0 {
        eprintln!(
            "note: mix and emission of the shot are of its picture, not of the file: give the shot to `rebounce render`"
        );
    }
    if let Some(environment) = read_environment(&shot, path)? {
        scene.environment = Some(environment);
    }
    scene.lights.clear();
    scene.light_names.clear();
    for (i, mut light) in shot.lights.into_iter().enumerate() {
        if let Light::Environment { file, .. } = &mut light {
            *file = None;
        }
        // Emissive surfaces are groups by themselves.
        if light.kind().is_lamp() || light.kind() == LightKind::Environment {
            scene.lights.push(light);
            scene.light_names.push(shot.light_names.get(i).cloned().unwrap_or_default());
        }
    }
    Ok(shot.camera)
}

impl SolveArgs {
    fn antiradiance(&self) -> AntiradianceSettings {
        AntiradianceSettings {
            elements: self.elements.unwrap_or(AntiradianceSettings::default().elements),
            gloss: self.gloss,
            solver: SolverSettings {
                bins: self.bins,
                width: self.link_width,
                spreading: match self.spreading {
                    SpreadingName::Exact => Spreading::Exact,
                    SpreadingName::Gaussian => Spreading::Gaussian,
                },
                iteration: match self.iteration {
                    IterationName::Ordered => Iteration::Ordered,
                    IterationName::Symmetric => Iteration::Symmetric,
                    IterationName::Asymmetric => Iteration::Asymmetric(self.antiradiance_steps + 1),
                },
                iterations: self.iterations,
                tolerance: self.change,
            },
        }
    }

    fn settings(&self) -> SolveSettings {
        let mut bake = BakeSettings::new(self.preset.into());
        bake.viewpoints.clone_from(&self.viewpoint);
        bake.place.functions = self.functions.unwrap_or(bake.place.functions);
        bake.operator.bounces = self.bounces;
        self.layout.apply(&mut bake);
        let mut radiosity = RadiositySettings::default();
        radiosity.rays = self.rays.clone().unwrap_or(radiosity.rays);
        radiosity.epsilon_e = self.epsilon.unwrap_or(radiosity.epsilon_e);
        radiosity.epsilon_omega = self.sender_angle.unwrap_or(radiosity.epsilon_omega);
        radiosity.significance = self.significance.unwrap_or(radiosity.significance);
        let order = [Order::M1, Order::M2, Order::M3][usize::from(self.order - 1)];
        let solver = match self.solver {
            SolverName::Radiosity => FixedSolver::Radiosity,
            SolverName::Wavelet => FixedSolver::Wavelet(WaveletSettings {
                order,
                convergence: self.convergence,
                epsilon: self.tolerance,
                max_level: self.depth,
                ..WaveletSettings::default()
            }),
            SolverName::Antiradiance => FixedSolver::Antiradiance(self.antiradiance()),
        };
        SolveSettings { bake, radiosity, solver }
    }
}
