//! Progress of a bake in words, for people and for programs.

use rebounce::bake::{Progress, Stage};
use rebounce::job::clock;
use serde::Serialize;
use std::time::Duration;

/// Time between two lines for people.
pub const LINES: Duration = Duration::from_secs(10);
/// Time between two lines for programs.
pub const JSON_LINES: Duration = Duration::from_millis(250);

/// State of the last line.
#[derive(Default)]
pub struct LastShown {
    part: Option<(Stage, Option<usize>)>,
    at: Option<Duration>,
    /// Seconds since the bake began.
    seconds: f64,
    fraction: f64,
}

impl LastShown {
    /// Whether a new line is due: at a new stage or level, or after `pause`.
    pub fn is_due(&mut self, progress: &Progress, pause: Duration) -> bool {
        let (part, now) = (Some((progress.stage, progress.level)), clock::wall());
        let is_due = self.part != part || self.at.is_none_or(|at| now.saturating_sub(at) >= pause);
        if is_due {
            (self.part, self.at) = (part, Some(now));
        }
        is_due
    }

    /// Fraction done, 0 to 1; never decreases within a bake, even if additional work was found.
    fn fraction(&mut self, progress: &Progress) -> f64 {
        let shown = if progress.seconds < self.seconds { 0.0 } else { self.fraction };
        (self.seconds, self.fraction) = (progress.seconds, progress.fraction().max(shown));
        self.fraction
    }

    /// Returns a line for people.
    pub fn line(&self, progress: &Progress) -> String {
        format!("{:3.0}%, {}", 100.0 * progress.fraction(), sentence(progress))
    }

    /// Returns a line of `--json-progress`.
    pub fn json<'a>(&mut self, progress: &'a Progress) -> ProgressLine<'a> {
        ProgressLine {
            stage: progress.stage.label(),
            level: progress.level,
            done: progress.done,
            total: progress.total,
            rays_per_second: progress.rays_per_second,
            seconds: progress.seconds,
            seconds_left: progress.seconds_left,
            processor_seconds: progress.processor_seconds,
            processor_seconds_left: progress.processor_seconds_left,
            fraction: self.fraction(progress),
            measured: None,
        }
    }
}

/// A line of `--json-progress`.
#[derive(Serialize)]
pub struct ProgressLine<'a> {
    stage: &'a str,
    level: Option<usize>,
    done: u64,
    total: u64,
    rays_per_second: Option<f64>,
    seconds: f64,
    seconds_left: f64,
    processor_seconds: f64,
    processor_seconds_left: f64,
    fraction: f64,
    /// Error of the file, on the last line, if measured.
    #[serde(flatten)]
    measured: Option<Measured>,
}

/// Measured error of a file, and its interval.
#[derive(Serialize)]
pub struct Measured {
    /// The error, unless noise hides it.
    pub measured_error: Option<f64>,
    /// Lower bound.
    pub measured_error_at_least: Option<f64>,
    /// Upper bound.
    pub measured_error_at_most: Option<f64>,
}

impl ProgressLine<'_> {
    /// The last line of a finished bake: wall-clock and processor seconds since it began, and the error of its file.
    pub fn done(seconds: f64, processor_seconds: f64, measured: Option<Measured>) -> Self {
        ProgressLine {
            stage: "done",
            level: None,
            done: 0,
            total: 0,
            rays_per_second: None,
            seconds,
            seconds_left: 0.0,
            processor_seconds,
            processor_seconds_left: 0.0,
            fraction: 1.0,
            measured,
        }
    }
}

/// Returns the stage, its figures and the time left, in words.
pub fn sentence(progress: &Progress) -> String {
    let mut said = progress.stage.label().to_owned();
    if let Some(level) = progress.level {
        said.push_str(&format!(", level {level}"));
    }
    if let Some(rays) = progress.rays_per_second {
        said.push_str(&format!(", {:.2} M rays/s", rays / 1e6));
    }
    said.push_str(", ");
    said.push_str(&time_left(progress.seconds_left));
    said
}

/// Formats the remaining time, rounded to the accuracy of the estimate.
fn time_left(seconds: f64) -> String {
    match seconds {
        s if s < 20.0 => format!("{s:.0} s left"),
        s if s < 120.0 => format!("{:.0} s left", (s / 5.0).round() * 5.0),
        s if s < 3600.0 => format!("{:.0} min left", (s / 60.0).round()),
        s => format!("{:.1} h left", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_left_is_rounded() {
        let said = [3.4, 47.0, 130.0, 5400.0].map(time_left);
        assert_eq!(said, ["3 s left", "45 s left", "2 min left", "1.5 h left"]);
    }

    #[test]
    fn lines_come_with_stages_and_with_time() {
        let mut last = LastShown::default();
        let mut progress = Progress {
            stage: Stage::Links,
            level: Some(1),
            done: 1,
            total: 2,
            rays_per_second: None,
            seconds: 1.0,
            seconds_left: 1.0,
            processor_seconds: 2.0,
            processor_seconds_left: 2.0,
        };
        let long = Duration::from_secs(1000);
        assert!(last.is_due(&progress, long) && !last.is_due(&progress, long));
        assert!(last.is_due(&progress, Duration::ZERO));
        progress.level = Some(2);
        assert!(last.is_due(&progress, long));
        // 50% done; then the estimate of remaining work grows; then a new bake begins.
        assert_eq!(last.fraction(&progress), 0.5);
        (progress.seconds, progress.seconds_left) = (2.0, 8.0);
        assert_eq!(last.fraction(&progress), 0.5);
        progress.seconds = 0.0;
        assert_eq!(last.fraction(&progress), 0.0);
    }
}
