//! The checkpoint to resume.

use anyhow::{Context, Result};
use rebounce::bake::{Checkpoint, CheckpointError, Identity};
use rebounce::scene::Scene;
use rebounce_args::bake::BakeArgs;
use rebounce_args::plan::Plan;
use std::path::{Path, PathBuf};

/// Suffix of the checkpoint, after the output's file name.
const PARTIAL: &str = ".partial";

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
