//! `rebounce bake`: a scene in, a .rbn file out.
//!
//! * `args` – what it is told; `plan` – what is baked, and the checkpoint; `aim` – whether it is good enough;
//! * `observers` – who hears of it.

mod aim;
mod args;
mod observers;
mod plan;

pub use args::BakeArgs;

use super::plain::plain;
use super::progress::{Display, Unfinished};
use super::stop::Stop;
use super::team::with_team;
use super::view::PREVIEW;
use aim::{Aim, Last, Outcome, shot_for};
use anyhow::{Context, Result, ensure};
use cpu_time::ProcessTime;
use observers::{Follower, Watcher};
use plan::{Plan, open_checkpoint};
use rebounce::bake::{BakeError, BakeReport, Checkpoint, Identity, bake_in_team, budget};
use rebounce::scene::{self, Scene};
use rebounce::{team::Team, write::write_whole};
use rebounce_shared::rbn::container;
use std::path::Path;
use std::process::ExitCode;
use std::sync::{Arc, Once};
use std::time::Instant;

/// The exit code of a bake whose error is too large.
const OVER_TARGET: u8 = 3;

/// Runs the command.
pub fn run(args: &BakeArgs) -> Result<ExitCode> {
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().context("setting up threads")?;
    }
    with_team(|team| {
        ensure!(
            team.size() == 1 || args.target_error.is_none(),
            "--target-error bakes several times and measures in between, which is for one process: give several a --preset"
        );
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
    let settings = Plan::asked_for(args, scene)?.settings;
    match bake_in_team(scene, &settings, &Follower(stop.clone()), None, team) {
        Ok(_) => Ok(0),
        Err(BakeError::Stopped) => Ok(stop.exit_code()),
        Err(error) => Err(error).context(args.scene.clone()),
    }
}

/// The first process's part, or all of it.
fn lead(args: &BakeArgs, scene: &Scene, team: &dyn Team) -> Result<u8> {
    let output = args.output();
    for problem in &scene.left_out {
        eprintln!("warning: left out: {}", plain(problem));
    }
    let shot = match args.target_error {
        Some(_) => shot_for(args.shot.as_deref(), &args.scene, scene)?,
        None => None,
    };
    let mut aim = match (args.target_error, &shot) {
        (Some(target), Some(shot)) => Some(Aim::new(target, scene, shot, args.bounces)?),
        _ => None,
    };
    let plans = match &aim {
        Some(_) => Plan::tries(args, scene)?,
        None => vec![Plan::asked_for(args, scene)?],
    };
    let (mut checkpoint, first) = open_checkpoint(args, &output, scene, &plans)?;
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
    // Of the file that is written.
    let mut written: Option<BakeReport> = None;
    let mut code = 0;
    for (number, Plan { settings, fewer }) in plans.iter().enumerate().skip(first) {
        if number > first {
            let path = checkpoint.path().to_owned();
            checkpoint.remove();
            checkpoint = Checkpoint::create(&path, &Identity::new(scene, settings))?;
        }
        if let Some(functions) = fewer {
            eprintln!("note: about {functions} functions on the finest level, to keep within the budget");
        }
        let (mut baked, mut report) = match bake_in_team(scene, settings, &watcher, Some(&checkpoint), team) {
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
                if written.is_some() {
                    eprintln!("note: {} has the best of the bakes before", output.display());
                }
                return Err(error).context(args.scene.clone());
            }
        };
        let thinned = args.max_bytes.map(|bytes| budget::fit(&mut baked, bytes)).transpose();
        let thinned = thinned.with_context(|| args.scene.clone())?.flatten();
        if let Some(thinned) = thinned {
            eprintln!(
                "note: {} of {} links are left, to keep within the budget",
                thinned.after, thinned.before
            );
        }
        let mut outcome = Outcome::Met;
        if let Some(aim) = &mut aim {
            let last = if fewer.is_some() || thinned.is_some() {
                Last::Budget
            } else if number + 1 == plans.len() {
                Last::Finest
            } else {
                Last::No
            };
            let name = format!("{}, {} functions", settings.preset.name(), report.functions);
            let measured = aim.measure(&baked, &name, last)?;
            outcome = measured.1;
            report.measured_error = Some(measured.0);
        }
        // Each bake that is better than those before is written: what follows may fail.
        if aim.as_ref().is_none_or(Aim::is_best) {
            let bytes = baked.to_bytes().with_context(|| args.scene.clone())?;
            stop.hold();
            write_out(args, &output, &bytes, &mut report, &checkpoint)?;
            written = Some(report);
        }
        match outcome {
            Outcome::Met => break,
            Outcome::Finer => stop.release(),
            Outcome::Missed => {
                code = OVER_TARGET;
                break;
            }
        }
    }
    stop.hold();
    checkpoint.remove();
    if let Some(preview) = &watcher.previews {
        // It may never have been written.
        let _ = std::fs::remove_file(preview);
    }
    watcher.display.finish(began.elapsed().as_secs_f64(), processors.elapsed().as_secs_f64());
    if let Some(report) = written.filter(|_| !watcher.display.is_json()) {
        println!("{report}");
        println!("wrote         {}", output.display());
    }
    Ok(code)
}

/// Writes the file and its report.
fn write_out(
    args: &BakeArgs,
    output: &Path,
    bytes: &[u8],
    report: &mut BakeReport,
    checkpoint: &Checkpoint,
) -> Result<()> {
    write_whole(output, bytes).with_context(|| {
        format!("the bake is done but not written; {} has it for --resume", checkpoint.path().display())
    })?;
    report.add_file(&container::read(bytes)?, bytes.len() as u64);
    if let Some(path) = &args.report {
        write_whole(path, &serde_json::to_vec_pretty(&report)?)?;
    }
    Ok(())
}
