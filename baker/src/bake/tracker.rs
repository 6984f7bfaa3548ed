//! Follows the work of all threads of a bake, and reports to the observer.

use super::estimate::Estimate;
use super::{Checkpoint, Observer, Progress, Stage};
use crate::job::clock;
use crate::job::communicator::share::Traffic;
use crate::job::reporter::{Reporter, Work};
use crate::job::watch::{Stopped, Watch};
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Time between two reports.
const PAUSE: Duration = Duration::from_millis(50);

/// Progress of the complete bake.
pub(super) struct Tracker<'a> {
    observer: &'a dyn Observer,
    checkpoint: Option<&'a Checkpoint>,
    /// Wall clock and processor time at the start.
    began: [Duration; 2],
    estimate: Mutex<Estimate>,
    /// Seconds per stage, in order of the first part of each stage.
    seconds: Mutex<Vec<(Stage, f64)>>,
    /// Bytes sent between processes, by stage and level.
    traffic: Mutex<Vec<StageTraffic>>,
}

/// Bytes that a stage has sent between processes.
pub(super) type StageTraffic = (Stage, Option<usize>, Traffic);

/// Wall clock and processor time.
fn now() -> [Duration; 2] {
    [clock::wall(), clock::processor()]
}

impl<'a> Tracker<'a> {
    pub(super) fn new(
        observer: &'a dyn Observer,
        checkpoint: Option<&'a Checkpoint>,
        estimate: Estimate,
    ) -> Self {
        Self {
            observer,
            checkpoint,
            began: now(),
            estimate: Mutex::new(estimate),
            seconds: Mutex::default(),
            traffic: Mutex::default(),
        }
    }

    /// Updates the estimate of the remaining work.
    pub(super) fn expect(&self, tell: impl FnOnce(&mut Estimate)) {
        if let Ok(mut estimate) = self.estimate.lock() {
            tell(&mut estimate);
        }
    }

    /// Begins a part of the work; the part ends when the task is dropped.
    pub(super) fn task(&self, stage: Stage, level: Option<usize>) -> Task<'_> {
        let (none, told) = (AtomicU64::new, now());
        let (began, told) = (told[0], Mutex::new(told));
        let task =
            Task { tracker: self, stage, level, began, done: none(0), skipped: none(0), due: none(0), told };
        task.tell();
        task
    }

    /// Returns the bytes sent between processes.
    pub(super) fn traffic(&self) -> Vec<StageTraffic> {
        self.traffic.lock().map(|traffic| traffic.clone()).unwrap_or_default()
    }

    /// Returns the seconds of each stage.
    pub(super) fn seconds(&self) -> Vec<(String, f64)> {
        let seconds = self.seconds.lock().map(|seconds| seconds.clone()).unwrap_or_default();
        seconds.into_iter().map(|(stage, seconds)| (stage.label().to_owned(), seconds)).collect()
    }
}

impl Reporter for Tracker<'_> {
    fn begin(&self, stage: Stage, level: Option<usize>) -> Box<dyn Watch + '_> {
        Box::new(self.task(stage, level))
    }

    fn expect(&self, work: Work) {
        self.expect(|estimate| match work {
            Work::Rays { level, rays } => estimate.expect_rays(level, rays as f64),
            Work::Multibounce { columns, entries } => estimate.expect_bounces(columns as f64, entries as f64),
        });
    }

    fn sent(&self, stage: Stage, level: Option<usize>, traffic: Traffic) {
        if let Ok(mut all) = self.traffic.lock() {
            all.push((stage, level, traffic));
        }
    }
}

/// A current part of a bake.
pub(super) struct Task<'t> {
    tracker: &'t Tracker<'t>,
    stage: Stage,
    level: Option<usize>,
    /// Wall clock at the start.
    began: Duration,
    done: AtomicU64,
    skipped: AtomicU64,
    /// Time of the next report, milliseconds after the task began.
    due: AtomicU64,
    /// Clock and processor time of the last update of the estimate.
    told: Mutex<[Duration; 2]>,
}

impl Task<'_> {
    fn tell(&self) {
        let Ok(mut told) = self.told.lock() else { return };
        let now = now();
        let (done, skipped) = (self.done.load(Ordering::Relaxed), self.skipped.load(Ordering::Relaxed));
        let last = std::mem::replace(&mut *told, now);
        let seconds = (now[0] - last[0]).as_secs_f64();
        let processor_seconds = (now[1] - last[1]).as_secs_f64();
        let part = (self.stage, self.level);
        let Ok(mut estimate) = self.tracker.estimate.lock() else { return };
        estimate.advance(part, done as f64, skipped as f64, seconds, processor_seconds);
        let (total, left) = (estimate.units(self.stage, self.level), estimate.left());
        drop(estimate);
        let spent = (now[0] - self.began).as_secs_f64();
        let rate = (done - skipped.min(done)) as f64 / spent.max(1e-3);
        self.tracker.observer.progress(&Progress {
            stage: self.stage,
            level: self.level,
            done,
            total: total as u64,
            rays_per_second: (self.stage == Stage::Links && rate > 0.0).then_some(rate),
            seconds: (now[0] - self.tracker.began[0]).as_secs_f64(),
            seconds_left: left.seconds,
            processor_seconds: (now[1] - self.tracker.began[1]).as_secs_f64(),
            processor_seconds_left: left.processor_seconds,
        });
    }
}

impl Watch for Task<'_> {
    fn step(&self, units: u64) -> Result<(), Stopped> {
        self.done.fetch_add(units, Ordering::Relaxed);
        let tracker = self.tracker;
        if tracker.observer.is_stopped() || tracker.checkpoint.is_some_and(Checkpoint::has_failed) {
            return Err(Stopped);
        }
        let now = (clock::wall() - self.began).as_millis() as u64;
        let due = self.due.load(Ordering::Relaxed);
        let next = now + PAUSE.as_millis() as u64;
        // Only one thread reports.
        if now >= due && self.due.compare_exchange(due, next, Ordering::Relaxed, Ordering::Relaxed).is_ok() {
            self.tell();
        }
        Ok(())
    }

    fn expect(&self, units: u64) {
        let part = (self.stage, self.level);
        self.tracker.expect(|estimate| estimate.expect_units(part, units as f64));
    }

    fn skip(&self, units: u64) -> Result<(), Stopped> {
        self.skipped.fetch_add(units, Ordering::Relaxed);
        self.step(units)
    }
}

impl Drop for Task<'_> {
    fn drop(&mut self) {
        self.tell();
        self.tracker.expect(|estimate| estimate.end(self.stage, self.level));
        if let Ok(mut seconds) = self.tracker.seconds.lock() {
            let spent = (clock::wall() - self.began).as_secs_f64();
            match seconds.iter_mut().find(|entry| entry.0 == self.stage) {
                Some(entry) => entry.1 += spent,
                None => seconds.push((self.stage, spent)),
            }
        }
    }
}
