//! Progress of a bake, for people and for programs.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rebounce::bake::{Progress, Stage};
use rebounce::verify::compare::uncertainty::ErrorEstimate;
use serde::Serialize;
use std::io::{IsTerminal, Write};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Steps of the bar.
const STEPS: u64 = 1000;
/// Time between two lines for people.
const LINES: Duration = Duration::from_secs(10);
/// Time between two lines for programs.
const JSON_LINES: Duration = Duration::from_millis(250);

/// Output of progress.
pub enum Display {
    /// One bar on a terminal.
    Bar(ProgressBar),
    /// Lines on standard error, at stages and every ten seconds.
    Lines(Mutex<LastShown>),
    /// JSON objects on standard output, one a line.
    Json(Mutex<LastShown>),
}

/// State of the last line.
#[derive(Default)]
pub struct LastShown {
    part: Option<(Stage, Option<usize>)>,
    at: Option<Instant>,
    /// Seconds since the bake began.
    seconds: f64,
    fraction: f64,
}

impl LastShown {
    /// Whether a new line is due: at a new stage or level, or after `pause`.
    fn is_due(&mut self, progress: &Progress, pause: Duration) -> bool {
        let part = Some((progress.stage, progress.level));
        let is_due = self.part != part || self.at.is_none_or(|at| at.elapsed() >= pause);
        if is_due {
            (self.part, self.at) = (part, Some(Instant::now()));
        }
        is_due
    }

    /// Fraction done, 0 to 1; never decreases within a bake, even if additional work was found.
    fn fraction(&mut self, progress: &Progress) -> f64 {
        let shown = if progress.seconds < self.seconds { 0.0 } else { self.fraction };
        (self.seconds, self.fraction) = (progress.seconds, progress.fraction().max(shown));
        self.fraction
    }
}

/// A line of `--json-progress`.
#[derive(Serialize)]
struct ProgressLine<'a> {
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

#[derive(Serialize)]
struct Measured {
    measured_error: Option<f64>,
    measured_error_at_least: Option<f64>,
    measured_error_at_most: Option<f64>,
}

/// The last line of `--json-progress` of an unfinished bake.
#[derive(Serialize)]
#[serde(tag = "stage", rename_all = "lowercase")]
pub enum Unfinished {
    /// The bake failed.
    Failed {
        /// The message on standard error.
        error: String,
    },
    /// The bake was stopped, and can be resumed.
    Stopped {
        /// Path of the checkpoint.
        checkpoint: String,
    },
}

impl Unfinished {
    /// Prints the line.
    pub fn print(&self) {
        line(self);
    }
}

impl Display {
    /// JSON if `json`, else a bar on a terminal, else lines.
    pub fn new(json: bool) -> Self {
        if json {
            return Self::Json(Mutex::default());
        }
        if !std::io::stderr().is_terminal() {
            return Self::Lines(Mutex::default());
        }
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("[{bar:30}] {percent:>3}%, {msg}") {
            bar.set_style(style.progress_chars("=> "));
        }
        Self::Bar(bar)
    }

    /// Shows the progress of the bake.
    pub fn show(&self, progress: &Progress) {
        match self {
            Self::Bar(bar) => {
                bar.set_position((progress.fraction() * STEPS as f64) as u64);
                bar.set_message(sentence(progress));
            }
            Self::Lines(last) => {
                if last.lock().is_ok_and(|mut last| last.is_due(progress, LINES)) {
                    eprintln!("{:3.0}%, {}", 100.0 * progress.fraction(), sentence(progress));
                }
            }
            Self::Json(last) => {
                let Ok(mut last) = last.lock() else { return };
                if last.is_due(progress, JSON_LINES) {
                    line(&ProgressLine {
                        stage: progress.stage.label(),
                        level: progress.level,
                        done: progress.done,
                        total: progress.total,
                        rays_per_second: progress.rays_per_second,
                        seconds: progress.seconds,
                        seconds_left: progress.seconds_left,
                        processor_seconds: progress.processor_seconds,
                        processor_seconds_left: progress.processor_seconds_left,
                        fraction: last.fraction(progress),
                        measured: None,
                    });
                }
            }
        }
    }

    /// Reports the end of the bake: wall-clock and processor seconds since the bake began, and the error of the written
    /// file.
    pub fn finish(&self, seconds: f64, processor_seconds: f64, error: Option<ErrorEstimate>) {
        match self {
            Self::Bar(bar) => bar.finish_and_clear(),
            Self::Lines(_) => {}
            Self::Json(_) => line(&ProgressLine {
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
                measured: error.map(|ErrorEstimate { value, at_least, at_most }| Measured {
                    measured_error: value,
                    measured_error_at_least: at_least,
                    measured_error_at_most: at_most,
                }),
            }),
        }
    }

    /// Whether standard output is for programs.
    pub fn is_json(&self) -> bool {
        matches!(self, Self::Json(_))
    }
}

fn line(line: &impl Serialize) {
    if let Ok(text) = serde_json::to_string(line) {
        // A closed standard output does not stop the bake.
        let _ = writeln!(std::io::stdout().lock(), "{text}");
    }
}

fn sentence(progress: &Progress) -> String {
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
