//! `rebounce bake`: a scene in, a .rbn file out.

use anyhow::{Context, Result};
use clap::{Args, ValueEnum};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rebounce::bake::{BakeSettings, Preset, Progress, Stage, bake};
use rebounce::{scene, write::write_whole};
use rebounce_shared::rbn::container;
use std::io::IsTerminal;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Arguments of `rebounce bake`.
#[derive(Args, Debug)]
pub struct BakeArgs {
    /// A .gltf or .glb file, or builtin:cornell-box, builtin:apartment, builtin:library, builtin:two-rooms-door,
    /// builtin:two-rooms
    scene: String,
    /// Where to write; SCENE.rbn when absent
    #[arg(short, long, value_name = "FILE.rbn")]
    output: Option<PathBuf>,
    /// How good and how costly
    #[arg(long, value_enum, default_value = "standard")]
    preset: PresetName,
    /// A point inside the scene, in its units; found when absent
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    viewpoint: Option<[f64; 3]>,
    /// Levels of receivers
    #[arg(long)]
    levels: Option<usize>,
    /// Levels of senders, the coarsest ones
    #[arg(long)]
    sender_levels: Option<usize>,
    /// Levels at whose points direct light is sampled
    #[arg(long)]
    direct_levels: Option<usize>,
    /// About how many functions the finest level has
    #[arg(long)]
    functions: Option<usize>,
    /// Poisson-disk radius of the coarsest level, scene units; overrides --functions
    #[arg(long)]
    coarse_radius: Option<f32>,
    /// Links weaker than this share of what the scene's surfaces reflect are given to a neighbour
    #[arg(long)]
    epsilon: Option<f32>,
    /// Links under this many standard deviations of their noise are given to a neighbour
    #[arg(long)]
    significance: Option<f32>,
    /// Rays per receiver, coarsest level first; the last number holds for finer levels
    #[arg(long, value_delimiter = ',')]
    rays: Option<Vec<u32>>,
    /// Bounces of light; all that matter when absent
    #[arg(long)]
    bounces: Option<u32>,
    /// Levels that light is gathered on to bounce again, the coarsest ones
    #[arg(long)]
    later_levels: Option<usize>,
    /// Support over disk radius, coarsest level
    #[arg(long)]
    coarse_overlap: Option<f32>,
    /// Support over disk radius, finest level
    #[arg(long)]
    fine_overlap: Option<f32>,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Threads; all cores when absent
    #[arg(long)]
    threads: Option<usize>,
    /// Writes the figures of the closing summary as JSON
    #[arg(long, value_name = "FILE.json")]
    report: Option<PathBuf>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum PresetName {
    /// To look at while arranging a scene: error under 0.15 against a path tracer, in seconds
    Draft,
    /// To ship: error under 0.08, in a minute or two for a room on two cores
    Standard,
    /// For stills and close looks: error under 0.06, in some minutes
    Fine,
}

fn parse_point(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text
        .split(',')
        .map(|part| part.trim().parse::<f64>().map_err(|e| e.to_string()))
        .collect::<Result<_, _>>()?;
    numbers.try_into().map_err(|_| "three numbers are needed, as in 0,1.5,-2".to_owned())
}

impl BakeArgs {
    fn settings(&self) -> BakeSettings {
        let mut s = BakeSettings::new(match self.preset {
            PresetName::Draft => Preset::Draft,
            PresetName::Standard => Preset::Standard,
            PresetName::Fine => Preset::Fine,
        });
        fn set<T: Clone>(value: &mut T, given: &Option<T>) {
            if let Some(given) = given {
                *value = given.clone();
            }
        }
        s.viewpoint = self.viewpoint;
        s.place.coarse_radius = self.coarse_radius;
        s.operator.bounces = self.bounces;
        set(&mut s.place.levels, &self.levels);
        set(&mut s.place.functions, &self.functions);
        set(&mut s.place.coarse_overlap, &self.coarse_overlap);
        set(&mut s.place.fine_overlap, &self.fine_overlap);
        set(&mut s.operator.sender_levels, &self.sender_levels);
        set(&mut s.operator.epsilon, &self.epsilon);
        set(&mut s.operator.significance, &self.significance);
        set(&mut s.operator.rays, &self.rays);
        set(&mut s.operator.later_levels, &self.later_levels);
        set(&mut s.direct_levels, &self.direct_levels);
        s.place.seed = self.seed;
        s.operator.seed = self.seed;
        s
    }

    fn output(&self) -> PathBuf {
        let name = || PathBuf::from(self.scene.rsplit([':', '/', '\\']).next().unwrap_or("scene"));
        self.output.clone().unwrap_or_else(|| name().with_extension("rbn"))
    }
}

/// Runs the command.
pub fn run(args: &BakeArgs) -> Result<()> {
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().context("setting up threads")?;
    }
    let output = args.output();
    let scene = scene::load(&args.scene)?;
    for problem in &scene.left_out {
        eprintln!("warning: left out: {problem}");
    }
    let display = ProgressDisplay::new();
    let (baked, mut report) = bake(&scene, &args.settings(), &|progress| display.show(progress))
        .with_context(|| args.scene.clone())?;
    display.finish();
    let bytes = baked.to_bytes().with_context(|| args.scene.clone())?;
    write_whole(&output, &bytes)?;
    report.add_file(&container::read(&bytes)?, bytes.len() as u64);
    println!("{report}");
    if let Some(path) = &args.report {
        write_whole(path, &serde_json::to_vec_pretty(&report)?)?;
    }
    println!("wrote         {}", output.display());
    Ok(())
}

/// A bar with stage and time left on a terminal, plain lines when piped.
struct ProgressDisplay {
    bar: ProgressBar,
    is_terminal: bool,
    state: Mutex<State>,
}

struct State {
    stage: Option<(Stage, usize)>,
    since: Instant,
    last_line: Instant,
}

impl ProgressDisplay {
    fn new() -> Self {
        let is_terminal = std::io::stderr().is_terminal();
        let target = if is_terminal { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(Some(0), target);
        let now = Instant::now();
        Self { bar, is_terminal, state: Mutex::new(State { stage: None, since: now, last_line: now }) }
    }

    fn show(&self, progress: Progress) {
        let Ok(mut state) = self.state.lock() else { return };
        let label = match progress.stage {
            Stage::Points | Stage::Links => format!("{}, level {}", progress.stage.label(), progress.level),
            stage => stage.label().to_owned(),
        };
        let now = Instant::now();
        if state.stage != Some((progress.stage, progress.level)) {
            state.stage = Some((progress.stage, progress.level));
            (state.since, state.last_line) = (now, now);
            self.bar.reset();
            let known = "{msg:30} [{bar:30}] {pos}/{len}, {eta} left";
            let template = if progress.total > 0 { known } else { "{msg:30} {pos} so far" };
            if let Ok(style) = ProgressStyle::with_template(template) {
                self.bar.set_style(style.progress_chars("=> "));
            }
            self.bar.set_message(label.clone());
            if !self.is_terminal {
                eprintln!("{label}");
            }
        }
        self.bar.set_length(progress.total);
        self.bar.set_position(progress.done);
        if !self.is_terminal && now - state.last_line > Duration::from_secs(10) && progress.done > 0 {
            state.last_line = now;
            let left =
                (now - state.since).as_secs_f64() * (progress.total as f64 / progress.done as f64 - 1.0);
            match progress.total {
                0 => eprintln!("{label}: {} so far", progress.done),
                total => eprintln!("{label}: {} of {total}, {left:.0} s left", progress.done),
            }
        }
    }

    fn finish(&self) {
        self.bar.finish_and_clear();
    }
}
