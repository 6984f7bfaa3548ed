//! Planned bakes, and the checkpoint to resume.

use super::args::BakeArgs;
use anyhow::{Context, Result};
use rebounce::bake::budget::{self, Budget};
use rebounce::bake::{BakeSettings, Checkpoint, CheckpointError, Identity, aim};
use rebounce::scene::Scene;
use rebounce_shared::camera::Camera;
use std::path::{Path, PathBuf};

/// Suffix of the checkpoint, after the output's file name.
const PARTIAL: &str = ".partial";

/// Plan of a single bake.
pub struct Plan {
    /// Settings within the budget.
    pub settings: BakeSettings,
    /// Number of functions, if lowered by the budget.
    pub fewer: Option<usize>,
}

impl Plan {
    /// Plans a bake with `settings`, or with fewer functions. `is_judged`: the bake is measured.
    ///
    /// # Errors
    /// If the scene by itself exceeds the budget.
    fn new(args: &BakeArgs, scene: &Scene, mut settings: BakeSettings, is_judged: bool) -> Result<Self> {
        let budget = Budget { bytes: args.max_bytes, memory: args.max_memory, is_judged };
        let fewer = budget::plan(scene, &mut settings, &budget).with_context(|| args.scene.clone())?;
        Ok(Self { settings, fewer })
    }

    /// Plans the requested bake, without a target error.
    ///
    /// # Errors
    /// If the bake cannot fit the budget.
    pub fn asked_for(args: &BakeArgs, scene: &Scene, camera: Option<&Camera>) -> Result<Self> {
        Self::new(args, scene, args.settings(args.preset()?, camera), false)
    }

    /// Plans successively finer bakes, tried in order until a bake is within the target.
    ///
    /// # Errors
    /// If the first bake cannot fit the budget.
    pub fn tries(args: &BakeArgs, scene: &Scene, camera: Option<&Camera>) -> Result<Vec<Self>> {
        let mut plans = Vec::new();
        for settings in aim::tries(|preset| args.settings(preset, camera)) {
            let plan = Self::new(args, scene, settings, true)?;
            // Later plans would be lowered to an equal number of functions.
            let is_last = plan.fewer.is_some();
            plans.push(plan);
            if is_last {
                break;
            }
        }
        Ok(plans)
    }
}

/// Opens the checkpoint beside the output, to resume or to begin, and returns the index of the matching plan.
///
/// # Errors
/// If the checkpoint belongs to a different bake, or cannot be opened.
pub fn open_checkpoint(
    args: &BakeArgs,
    output: &Path,
    scene: &Scene,
    plans: &[Plan],
) -> Result<(Checkpoint, usize)> {
    let mut path = output.as_os_str().to_owned();
    path.push(PARTIAL);
    let path = PathBuf::from(path);
    let is_there = path.metadata().is_ok_and(|metadata| metadata.len() > 0);
    let mut identities = plans.iter().map(|plan| Identity::new(scene, &plan.settings)).enumerate();
    let (mut number, mut identity) = identities.next().context("nothing to bake")?;
    if !args.resume {
        let checkpoint = Checkpoint::create(&path, &identity)?;
        if is_there {
            eprintln!("note: {} of an earlier bake is replaced", path.display());
        }
        return Ok((checkpoint, number));
    }
    let checkpoint = loop {
        match (Checkpoint::resume(&path, &identity), identities.next()) {
            (Err(CheckpointError::Other { .. } | CheckpointError::Foreign(_)), Some(next)) => {
                (number, identity) = next;
            }
            (found, _) => break found?,
        }
    };
    match checkpoint.records_found() {
        0 => eprintln!("note: {} has nothing to go on from; the bake begins anew", path.display()),
        _ => eprintln!("going on from {}", path.display()),
    }
    Ok((checkpoint, number))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;
    use rebounce::bake::Preset;

    #[derive(Parser)]
    struct CommandLine {
        #[command(flatten)]
        args: BakeArgs,
    }

    fn told(words: &[&str]) -> BakeArgs {
        let words = ["bake", "builtin:two-rooms-door"].iter().chain(words);
        CommandLine::try_parse_from(words).unwrap().args
    }

    #[test]
    fn a_target_is_tried_for_with_ever_more_functions_and_within_the_budget() {
        let args = told(&["--target-error", "0.1", "--bounces", "2"]);
        let scene = rebounce::io::load(&args.scene).unwrap();
        let plans = Plan::tries(&args, &scene, None).unwrap();
        assert!(plans.len() > 3 && plans[0].settings.preset == Preset::Draft);
        assert!(plans.iter().all(|plan| plan.settings.operator.bounces == Some(2) && plan.fewer.is_none()));
        let args = told(&["--target-error", "0.1", "--max-bytes", "4M"]);
        let plans = Plan::tries(&args, &scene, None).unwrap();
        // The last plan has the functions that fit the budget.
        assert!(plans.len() == 2 && plans[0].fewer.is_none(), "{}", plans.len());
        assert_eq!(plans[1].fewer, Some(plans[1].settings.place.functions));
        assert!(Plan::asked_for(&told(&["--max-bytes", "1K"]), &scene, None).is_err());
    }

    #[test]
    fn going_on_means_going_on_with_the_try_that_was_stopped() {
        let folder = tempfile::tempdir().unwrap();
        let output = folder.path().join("rooms.rbn");
        let args = told(&["--target-error", "0.1", "--resume"]);
        let scene = rebounce::io::load(&args.scene).unwrap();
        let plans = Plan::tries(&args, &scene, None).unwrap();
        let opened = |plans: &[Plan]| {
            open_checkpoint(&args, &output, &scene, plans)
                .map(|(_, number)| number)
                .map_err(|e| e.to_string())
        };
        // No checkpoint exists.
        assert_eq!(opened(&plans), Ok(0));
        for (number, plan) in plans.iter().enumerate() {
            let path = folder.path().join("rooms.rbn.partial");
            drop(Checkpoint::create(&path, &Identity::new(&scene, &plan.settings)).unwrap());
            assert_eq!(opened(&plans), Ok(number));
        }
        // The checkpoint of the last plan matches neither of the first two.
        assert!(opened(&plans[..2]).unwrap_err().contains("another bake"));
    }
}
