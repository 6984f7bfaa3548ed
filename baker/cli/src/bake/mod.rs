//! `rebounce bake`: a scene in, a .rbn file out.
//!
//! * `checkpoint` – the file to resume from; `tries` – bakes, until `aim` finds the error within the
//!   target; `observers` – progress, previews and signals.

mod aim;
mod checkpoint;
mod observers;
mod tries;

use super::TOO_NOISY;
use super::communicator::with_communicator;
use super::load::{note, warn};
use super::picture::set_threads;
use super::progress::{Display, Unfinished};
use super::stop::Stop;
use aim::{Aim, shot_for};
use anyhow::{Context, Result, ensure};
use checkpoint::open_checkpoint;
use cpu_time::ProcessTime;
use observers::{Follower, Watcher};
use rebounce::bake::{BakeError, BakeReport, Baker, Checkpoint};
use rebounce::io::files::Disk;
use rebounce::job::communicator::Communicator;
use rebounce::scene::{self, Scene};
use rebounce_args::bake::BakeArgs;
use rebounce_args::escape::escape_controls;
use rebounce_args::paths::DiskPlaces;
use rebounce_args::plan::Plan;
use std::process::ExitCode;
use std::sync::{Arc, Once};
use std::time::Instant;
use tries::{Ended, Tries};

/// The exit code of a bake whose error is too large.
const OVER_TARGET: u8 = 3;

/// Runs the command.
pub fn run(args: &BakeArgs) -> Result<ExitCode> {
    set_threads(args.threads)?;
    with_communicator(|communicator| {
        ensure!(
            communicator.size() == 1 || args.target_error.is_none(),
            "--target-error bakes several times and measures in between, which is for one process: give several a --preset"
        );
        if communicator.rank() != 0 {
            return follow(args, &args.scene(&Disk, &mut |_| ())?, communicator);
        }
        // Until the scene is loaded, signals end the process at once.
        let loaded = args.check(&DiskPlaces).and_then(|()| args.scene(&Disk, &mut note)).map_err(Into::into);
        let done = loaded.and_then(|scene: Scene| lead(args, &scene, communicator));
        if let Some(error) = done.as_ref().err().filter(|_| args.json_progress) {
            Unfinished::Failed { error: escape_controls(&crate::sentence(error)).into_owned() }.print();
        }
        done
    })
}

/// Work of a process other than the first: bakes, and leaves files and messages to the first process.
fn follow(args: &BakeArgs, scene: &Scene, communicator: &dyn Communicator) -> Result<u8> {
    let stop = Stop::install(|| ()).context("setting up signals")?;
    let shot = args.shot(&Disk)?;
    let settings = Plan::asked_for(args, scene, shot.as_ref().map(|shot| &shot.camera))?.settings;
    match Baker::new(&settings).observer(&Follower(stop.clone())).communicator(communicator).bake(scene) {
        Ok(_) => Ok(0),
        Err(BakeError::Stopped) => Ok(stop.exit_code()),
        Err(error) => Err(error).context(args.scene.clone()),
    }
}

/// Work of the first process, or of a single process.
fn lead(args: &BakeArgs, scene: &Scene, communicator: &dyn Communicator) -> Result<u8> {
    let output = args.output();
    warn(scene);
    if let Some(far) = scene::outliers::far_away(scene) {
        eprintln!("warning: {}", escape_controls(&far));
    }
    let given = args.shot(&Disk)?;
    let camera = given.as_ref().map(|shot| shot.camera.clone());
    let shot = match args.target_error {
        Some(_) => shot_for(given, &args.scene, scene)?,
        None => None,
    };
    let aim = match (args.target_error, &shot) {
        (Some(target), Some(shot)) => Some(Aim::new(target, scene, shot, args.bounces)?),
        _ => None,
    };
    let plans = match &aim {
        Some(_) => Plan::tries(args, scene, camera.as_ref())?,
        None => vec![Plan::asked_for(args, scene, camera.as_ref())?],
    };
    let (checkpoint, first) = open_checkpoint(args, &output, scene, &plans)?;
    let last_words = last_words(&checkpoint, communicator, args.json_progress);
    let stop = Stop::install(last_words.clone()).context("setting up signals")?;
    let previews = args.preview_output();
    let watcher = Watcher { display: Display::new(args.json_progress), stop, previews };
    let (began, processors) = (Instant::now(), ProcessTime::now());
    let mut tries = Tries { args, scene, communicator, watcher, output, aim, written: None };
    let code = match tries.run(&plans, first, checkpoint)? {
        Ended::Met => 0,
        Ended::Missed => OVER_TARGET,
        Ended::TooNoisy => TOO_NOISY,
        Ended::Elsewhere => return Ok(0),
        Ended::Stopped => {
            last_words();
            return Ok(tries.watcher.stop.exit_code());
        }
    };
    let Tries { output, watcher, written, .. } = tries;
    let error = written.as_ref().and_then(BakeReport::measured);
    watcher.display.finish(began.elapsed().as_secs_f64(), processors.elapsed().as_secs_f64(), error);
    if let Some(report) = written.filter(|_| !watcher.display.is_json()) {
        println!("{report}");
        println!("wrote         {}", output.display());
    }
    Ok(code)
}

/// Returns a function that prints the message of a stopped bake; only the first call prints.
fn last_words(
    checkpoint: &Checkpoint,
    communicator: &dyn Communicator,
    is_json: bool,
) -> impl Fn() + Clone + Send + 'static {
    let kept = checkpoint.path().display().to_string();
    let why = match communicator.size() {
        1 => "stopped",
        _ => "stopped, or ended because another process of this bake was lost",
    };
    let said = Arc::new(Once::new());
    move || {
        said.call_once(|| {
            eprintln!("rebounce: {why}; {kept} has what was done, and --resume goes on from it");
            if is_json {
                Unfinished::Stopped { checkpoint: kept.clone() }.print();
            }
        });
    }
}
