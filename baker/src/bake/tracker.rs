//! Follows the work of all threads of a bake, and reports to the observer.

use super::estimate::Estimate;
use super::{Checkpoint, Observer, Progress, Stage};
use crate::job::watch::{Stopped, Watch};
use cpu_time::ProcessTime;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Time between two reports.
const PAUSE: Duration = Duration::from_millis(50);

/// Progress of the complete bake.
pub(super) struct Tracker<'a> {
    observer: &'a dyn Observer,
    checkpoint: Option<&'a Checkpoint>,
    began: Instant,
    /// Start of the processor time.
    processors: ProcessTime,
    estimate: Mutex<Estimate>,
    /// Seconds per stage, in order of the first part of each stage.
    seconds: Mutex<Vec<(Stage, f64)>>,
}

impl<'a> Tracker<'a> {
    pub(super) fn new(
        observer: &'a dyn Observer,
        checkpoint: Option<&'a Checkpoint>,
        estimate: Estimate,
    ) -> Self {
        let began = Instant::now();
        let processors = ProcessTime::now();
        Self {
            observer,
            checkpoint,
            began,
            processors,
            estimate: Mutex::new(estimate),
            seconds: Mutex::default(),
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
        let (none, began) = (AtomicU64::new, Instant::now());
        let told = Mutex::new((began, ProcessTime::now()));
        let task =
            Task { tracker: self, stage, level, began, done: none(0), skipped: none(0), due: none(0), told };
        task.tell();
        task
    }

    /// Returns the seconds of each stage.
    pub(super) fn seconds(&self) -> Vec<(String, f64)> {
        let seconds = self.seconds.lock().map(|seconds| seconds.clone()).unwrap_or_default();
        seconds.into_iter().map(|(stage, seconds)| (stage.label().to_owned(), seconds)).collect()
    }
}

/// A current part of a bake.
pub(super) struct Task<'t> {
    tracker: &'t Tracker<'t>,
    stage: Stage,
    level: Option<usize>,
    began: Instant,
    done: AtomicU64,
    skipped: AtomicU64,
    /// Time of the next report, milliseconds after the task began.
    due: AtomicU64,
    /// Clock and processor time of the last update of the estimate.
    told: Mutex<(Instant, ProcessTime)>,
}

impl Task<'_> {
    fn tell(&self) {
        let Ok(mut told) = self.told.lock() else { return };
        let now = (Instant::now(), ProcessTime::now());
        let (done, skipped) = (self.done.load(Ordering::Relaxed), self.skipped.load(Ordering::Relaxed));
        let last = std::mem::replace(&mut *told, now);
        let seconds = now.0.duration_since(last.0).as_secs_f64();
        let processor_seconds = now.1.duration_since(last.1).as_secs_f64();
        let part = (self.stage, self.level);
        let Ok(mut estimate) = self.tracker.estimate.lock() else { return };
        estimate.advance(part, done as f64, skipped as f64, seconds, processor_seconds);
        let (total, left) = (estimate.units(self.stage, self.level), estimate.left());
        drop(estimate);
        let spent = (now.0 - self.began).as_secs_f64();
        let rate = (done - skipped.min(done)) as f64 / spent.max(1e-3);
        self.tracker.observer.progress(&Progress {
            stage: self.stage,
            level: self.level,
            done,
            total: total as u64,
            rays_per_second: (self.stage == Stage::Links && rate > 0.0).then_some(rate),
            seconds: (now.0 - self.tracker.began).as_secs_f64(),
            seconds_left: left.seconds,
            processor_seconds: now.1.duration_since(self.tracker.processors).as_secs_f64(),
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
        let now = self.began.elapsed().as_millis() as u64;
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
            let spent = self.began.elapsed().as_secs_f64();
            match seconds.iter_mut().find(|entry| entry.0 == self.stage) {
                Some(entry) => entry.1 += spent,
                None => seconds.push((self.stage, spent)),
            }
        }
    }
}
