//! `rebounce bake`: a scene in, a .rbn file out.

use super::plain::plain;
use super::progress::{Display, Unfinished};
use super::stop::Stop;
use super::team::with_team;
use super::view::PREVIEW;
use anyhow::{Context, Result};
use clap::builder::RangedU64ValueParser;
use clap::{Args, ValueEnum};
use cpu_time::ProcessTime;
use rebounce::bake::budget::{self, Budget};
use rebounce::bake::{
    BakeError, BakeSettings, Checkpoint, Identity, Observer, Preset, Preview, Progress, bake_in_team,
};
use rebounce::scene::{self, Scene};
use rebounce::{team::Team, write::write_whole};
use rebounce_shared::rbn::{MAX_LEVELS, container};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::{Arc, Once};
use std::time::Instant;

const AFTER_HELP: &str = "\
A bake keeps what it has done in FILE.rbn.partial beside its output. When it was stopped or killed, the same command with \
--resume goes on from there; the result is the same file, to the byte. It is removed when the bake is done. FILE.rbn itself \
is replaced only then, and at once.

Where it is built with the feature mpi, `mpirun -n 4 rebounce bake ...` shares the work among four processes; the result \
is the same file, to the byte, and --resume goes on with any number of them.

Exit codes: 0 done; 1 failed; 2 wrong arguments; 130 stopped by Ctrl-C, 143 by SIGTERM, --resume goes on.

--json-progress prints objects with stage, level (or null), done and total (units of this stage and level), rays_per_second \
(or null), seconds (since the bake began), seconds_left, processor_seconds and processor_seconds_left (of all threads together: they do \
not count what else the machine does), fraction (0 to 1); the last one has the stage \"done\", or \"failed\" and error, or \"stopped\" and checkpoint, the file to go on from. \
A signal ends the command at once, and without a last line, while it reads the scene.";

/// Arguments of `rebounce bake`.
#[derive(Args, Debug)]
#[command(after_help = AFTER_HELP)]
pub struct BakeArgs {
    /// A .gltf or .glb file, or builtin:cornell-box, builtin:apartment, builtin:library, builtin:theatre,
    /// builtin:two-rooms-door, builtin:two-rooms, builtin:furnace
    scene: String,
    /// Where to write; SCENE.rbn when absent
    #[arg(short, long, value_name = "FILE.rbn")]
    output: Option<PathBuf>,
    /// How good and how costly
    #[arg(long, value_enum, default_value = "standard")]
    preset: PresetName,
    /// Takes the coarsest preset that is made for this error against a path tracer, as in 0.1
    #[arg(long, value_name = "ERROR", conflicts_with = "preset")]
    target_error: Option<f64>,
    /// Most bytes of the file, as in 8M: fewer functions, then fewer links
    #[arg(long, value_name = "BYTES", value_parser = parse_bytes)]
    max_bytes: Option<u64>,
    /// Most bytes of memory, about, as in 2G: fewer functions
    #[arg(long, value_name = "BYTES", value_parser = parse_bytes)]
    max_memory: Option<u64>,
    /// A point inside the scene, in its units; found when absent
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    viewpoint: Option<[f64; 3]>,
    /// Levels of receivers
    #[arg(long, value_parser = RangedU64ValueParser::<usize>::new().range(1..=MAX_LEVELS as u64))]
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
    /// Goes on with a bake that was stopped or killed: the same scene, settings and output
    #[arg(long)]
    resume: bool,
    /// Writes FILE.preview.rbn, coarse at first and finer as levels are done, for `rebounce view --watch`
    #[arg(long)]
    preview: bool,
    /// Prints progress as JSON, one object a line, on standard output, and no summary
    #[arg(long)]
    json_progress: bool,
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

/// A number with K, M or G behind it: thousands, millions, milliards.
fn parse_bytes(text: &str) -> Result<u64, String> {
    let (digits, unit) = match text.trim().to_ascii_uppercase().trim_end_matches('B') {
        text if text.ends_with('K') => (text.trim_end_matches('K').to_owned(), 1e3),
        text if text.ends_with('M') => (text.trim_end_matches('M').to_owned(), 1e6),
        text if text.ends_with('G') => (text.trim_end_matches('G').to_owned(), 1e9),
        text => (text.to_owned(), 1.0),
    };
    let number: f64 = digits.trim().parse().map_err(|_| "a number of bytes is needed, as in 8M or 2.5G")?;
    let bytes = number * unit;
    if bytes.is_finite() && bytes >= 1.0 { Ok(bytes as u64) } else { Err("more than that".to_owned()) }
}

impl BakeArgs {
    fn settings(&self) -> Result<BakeSettings> {
        let mut s = BakeSettings::new(match (self.target_error, self.preset) {
            (Some(error), _) => budget::preset_for(error)?,
            (None, PresetName::Draft) => Preset::Draft,
            (None, PresetName::Standard) => Preset::Standard,
            (None, PresetName::Fine) => Preset::Fine,
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
        Ok(s)
    }

    fn output(&self) -> PathBuf {
        let name = || PathBuf::from(self.scene.rsplit([':', '/', '\\']).next().unwrap_or("scene"));
        self.output.clone().unwrap_or_else(|| name().with_extension("rbn"))
    }
}

/// What follows a file's name while it is not done.
const PARTIAL: &str = ".partial";

/// Runs the command.
pub fn run(args: &BakeArgs) -> Result<ExitCode> {
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().context("setting up threads")?;
    }
    with_team(|team| {
        if team.rank() != 0 {
            return follow(args, &scene::load(&args.scene)?, team);
        }
        // Until here, and while this loads, signals end the process at once.
        let loaded = scene::load(&args.scene).map_err(anyhow::Error::from);
        let done = loaded.and_then(|scene| lead(args, &scene, team));
        if let Some(error) = done.as_ref().err().filter(|_| args.json_progress) {
            Unfinished::Failed { error: plain(&crate::sentence(error)).into_owned() }.print();
        }
        done
    })
}

/// The part of a process that is not the first of its team: it works, and leaves files and words to the first.
fn follow(args: &BakeArgs, scene: &Scene, team: &dyn Team) -> Result<u8> {
    let stop = Stop::install(|| ()).context("setting up signals")?;
    let (settings, _) = planned(args, scene)?;
    match bake_in_team(scene, &settings, &Follower(stop.clone()), None, team) {
        Ok(_) => Ok(0),
        Err(BakeError::Stopped) => Ok(stop.exit_code()),
        Err(error) => Err(error).context(args.scene.clone()),
    }
}

/// The settings within the budget, and the number of functions where it is lowered.
fn planned(args: &BakeArgs, scene: &Scene) -> Result<(BakeSettings, Option<usize>)> {
    let mut settings = args.settings()?;
    let budget = Budget { bytes: args.max_bytes, memory: args.max_memory };
    let fewer = budget::plan(scene, &mut settings, &budget).with_context(|| args.scene.clone())?;
    Ok((settings, fewer))
}

/// The first process's part, or all of it.
fn lead(args: &BakeArgs, scene: &Scene, team: &dyn Team) -> Result<u8> {
    let output = args.output();
    for problem in &scene.left_out {
        eprintln!("warning: left out: {}", plain(problem));
    }
    let (settings, fewer) = planned(args, scene)?;
    if let Some(functions) = fewer {
        eprintln!("note: about {functions} functions on the finest level, to keep within the budget");
    }
    let checkpoint = open_checkpoint(args, &output, &Identity::new(scene, &settings))?;
    let kept = checkpoint.path().display().to_string();
    let why = match team.size() {
        1 => "stopped",
        _ => "stopped, or ended because another process of this bake was lost",
    };
    let (said, is_json) = (Arc::new(Once::new()), args.json_progress);
    let last_words = move || {
        said.call_once(|| {
            eprintln!("rebounce: {why}; {kept} has what was done, and --resume goes on from it");
            if is_json {
                Unfinished::Stopped { checkpoint: kept.clone() }.print();
            }
        });
    };
    let stop = Stop::install(last_words.clone()).context("setting up signals")?;
    let previews = args.preview.then(|| output.with_extension(PREVIEW));
    let watcher = Watcher { display: Display::new(args.json_progress), stop: stop.clone(), previews };
    let (began, processors) = (Instant::now(), ProcessTime::now());
    let (mut baked, mut report) = match bake_in_team(scene, &settings, &watcher, Some(&checkpoint), team) {
        Ok(Some(baked)) => baked,
        // Nobody but the first process has no result.
        Ok(None) => return Ok(0),
        Err(BakeError::Stopped) => {
            last_words();
            return Ok(stop.exit_code());
        }
        Err(error @ (BakeError::Checkpoint(_) | BakeError::Apart(_) | BakeError::Team(_))) => {
            return Err(error.into());
        }
        Err(error) => {
            // It would end the same way again.
            checkpoint.remove();
            return Err(error).context(args.scene.clone());
        }
    };
    let thinned = args.max_bytes.map(|bytes| budget::fit(&mut baked, bytes)).transpose();
    if let Some(thinned) = thinned.with_context(|| args.scene.clone())?.flatten() {
        eprintln!("note: {} of {} links are left, to keep within the budget", thinned.after, thinned.before);
    }
    let bytes = baked.to_bytes().with_context(|| args.scene.clone())?;
    stop.hold();
    write_whole(&output, &bytes).with_context(|| {
        format!("the bake is done but not written; {} has it for --resume", checkpoint.path().display())
    })?;
    checkpoint.remove();
    if let Some(preview) = &watcher.previews {
        // It may never have been written.
        let _ = std::fs::remove_file(preview);
    }
    report.add_file(&container::read(&bytes)?, bytes.len() as u64);
    if let Some(path) = &args.report {
        write_whole(path, &serde_json::to_vec_pretty(&report)?)?;
    }
    watcher.display.finish(began.elapsed().as_secs_f64(), processors.elapsed().as_secs_f64());
    if !watcher.display.is_json() {
        println!("{report}");
        println!("wrote         {}", output.display());
    }
    Ok(0)
}

/// The checkpoint beside the output, to go on with or to begin.
fn open_checkpoint(args: &BakeArgs, output: &Path, identity: &Identity) -> Result<Checkpoint> {
    let mut path = output.as_os_str().to_owned();
    path.push(PARTIAL);
    let path = PathBuf::from(path);
    let is_there = path.metadata().is_ok_and(|metadata| metadata.len() > 0);
    if !args.resume {
        let checkpoint = Checkpoint::create(&path, identity)?;
        if is_there {
            eprintln!("note: {} of an earlier bake is replaced", path.display());
        }
        return Ok(checkpoint);
    }
    let checkpoint = Checkpoint::resume(&path, identity)?;
    match checkpoint.records_found() {
        0 => eprintln!("note: {} has nothing to go on from; the bake begins anew", path.display()),
        _ => eprintln!("going on from {}", path.display()),
    }
    Ok(checkpoint)
}

/// Hands on signals.
struct Follower(Stop);

impl Observer for Follower {
    fn is_stopped(&self) -> bool {
        self.0.is_asked()
    }
}

/// Shows progress, hands on signals, writes previews.
struct Watcher {
    display: Display,
    stop: Stop,
    previews: Option<PathBuf>,
}

impl Observer for Watcher {
    fn progress(&self, progress: &Progress) {
        // What stops has its own last line.
        if !self.stop.is_asked() {
            self.display.show(progress);
        }
    }

    fn is_stopped(&self) -> bool {
        self.stop.is_asked()
    }

    fn wants_previews(&self) -> bool {
        self.previews.is_some()
    }

    fn preview(&self, preview: Preview) {
        let Some(path) = &self.previews else { return };
        let written = preview.file.to_bytes().map_err(|error| error.to_string());
        let written = written.and_then(|bytes| write_whole(path, &bytes).map_err(|error| error.to_string()));
        if let Err(error) = written {
            eprintln!("warning: no preview: {error}");
        }
    }
}
