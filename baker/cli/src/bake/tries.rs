//! The bakes of a command, in sequence until the error is within the target; the output is the best bake.

use super::aim::{Aim, Outcome, StopReason};
use super::observers::Watcher;
use crate::load::note;
use anyhow::{Context, Result};
use rebounce::bake::{BakeError, BakeReport, Baker, Checkpoint, Identity};
use rebounce::io::write::write_whole;
use rebounce::job::communicator::Communicator;
use rebounce::scene::Scene;
use rebounce_args::bake::BakeArgs;
use rebounce_args::plan::{Plan, thin};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::container;
use std::path::PathBuf;

/// Bakes of a scene by the communicator's first process, or by a single process.
pub struct Tries<'a> {
    pub args: &'a BakeArgs,
    pub scene: &'a Scene,
    pub communicator: &'a dyn Communicator,
    pub watcher: Watcher,
    /// Path of the output file.
    pub output: PathBuf,
    /// Target error; `None` accepts any bake.
    pub aim: Option<Aim<'a>>,
    /// Report of the written file.
    pub written: Option<BakeReport>,
}

/// Result of the bakes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// A file within the target.
    Met,
    /// A file over the target.
    Missed,
    /// A file for which noise hides whether the error is over the target.
    TooNoisy,
    /// This process is not the communicator's first.
    Elsewhere,
    /// Stopped; the checkpoint has the finished work.
    Stopped,
}

impl Tries<'_> {
    /// Bakes the plans from index `first` on; `checkpoint` belongs to plan `first`. Removes the checkpoint when no
    /// longer useful. From the writing of the file on, a forced exit waits.
    ///
    /// # Errors
    /// If a bake fails, or the file cannot be written.
    pub fn run(&mut self, plans: &[Plan], first: usize, mut checkpoint: Checkpoint) -> Result<Ended> {
        let mut ended = Ended::Met;
        for (number, plan) in plans.iter().enumerate().skip(first) {
            if number > first {
                let path = checkpoint.path().to_owned();
                checkpoint.remove();
                checkpoint = Checkpoint::create(&path, &Identity::new(self.scene, &plan.settings))?;
            }
            let (mut baked, mut report) = match self.bake(plan, &checkpoint) {
                Ok(Some(baked)) => baked,
                // Only the first process has a result.
                Ok(None) => return Ok(Ended::Elsewhere),
                Err(BakeError::Stopped) => return Ok(Ended::Stopped),
                Err(
                    error @ (BakeError::Checkpoint(_) | BakeError::Apart(_) | BakeError::Communicator(_)),
                ) => {
                    return Err(error.into());
                }
                Err(error) => {
                    // A resumed bake would fail again.
                    checkpoint.remove();
                    if self.written.is_some() {
                        eprintln!("note: {} has the best of the bakes before", self.output.display());
                    }
                    return Err(error).context(self.args.scene.clone());
                }
            };
            let thinned = thin(self.args, &mut baked, &mut note)?;
            let last = match (plan.fewer.is_some() || thinned.is_some(), number + 1 == plans.len()) {
                (true, _) => StopReason::Budget,
                (false, true) => StopReason::Finest,
                (false, false) => StopReason::No,
            };
            let outcome = self.measure(plan, &baked, &mut report, last)?;
            // Write every bake that is better than all before: the next bake may fail.
            if self.aim.as_ref().is_none_or(Aim::is_best) {
                self.write(&baked, report, &checkpoint)?;
                if let Err(error) = self.write_report() {
                    checkpoint.remove();
                    return Err(error);
                }
            }
            match outcome {
                Outcome::Met => break,
                Outcome::Finer => self.watcher.stop.release(),
                Outcome::Missed => {
                    ended = Ended::Missed;
                    break;
                }
                Outcome::TooNoisy => {
                    ended = Ended::TooNoisy;
                    break;
                }
            }
        }
        self.watcher.stop.hold();
        checkpoint.remove();
        Ok(ended)
    }

    fn bake(
        &self,
        plan: &Plan,
        checkpoint: &Checkpoint,
    ) -> Result<Option<(BakedScene, BakeReport)>, BakeError> {
        if let Some(sentence) = plan.note() {
            note(&sentence);
        }
        Baker::new(&plan.settings)
            .observer(&self.watcher)
            .checkpoint(Some(checkpoint))
            .communicator(self.communicator)
            .bake(self.scene)
    }

    /// Compares the bake's error with the target, and adds the error to `report`.
    fn measure(
        &mut self,
        plan: &Plan,
        baked: &BakedScene,
        report: &mut BakeReport,
        last: StopReason,
    ) -> Result<Outcome> {
        let Some(aim) = &mut self.aim else { return Ok(Outcome::Met) };
        let name = format!("{}, {} functions", plan.settings.preset.name(), report.functions);
        let (error, outcome) = aim.measure(baked, &name, last)?;
        report.add_error(error);
        Ok(outcome)
    }

    /// Writes the file. From then on, a forced exit waits.
    fn write(&mut self, baked: &BakedScene, mut report: BakeReport, checkpoint: &Checkpoint) -> Result<()> {
        let bytes = baked.to_bytes().with_context(|| self.args.scene.clone())?;
        self.watcher.stop.hold();
        write_whole(&self.output, &bytes).with_context(|| {
            let kept = checkpoint.path().display();
            format!("the bake is done but not written; {kept} has it for --resume")
        })?;
        self.watcher.end_previews();
        report.add_file(&container::read(&bytes)?, bytes.len() as u64);
        self.written = Some(report);
        Ok(())
    }

    /// Writes the report of the written file.
    fn write_report(&self) -> Result<()> {
        let (Some(path), Some(report)) = (&self.args.report, &self.written) else { return Ok(()) };
        let write = || -> Result<()> { Ok(write_whole(path, &serde_json::to_vec_pretty(report)?)?) };
        write().with_context(|| format!("{} is written, its report is not", self.output.display()))
    }
}
