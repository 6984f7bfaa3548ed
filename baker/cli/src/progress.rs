//! Progress of a bake on the terminal, and for programs.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rebounce::bake::Progress;
use rebounce::verify::compare::uncertainty::ErrorEstimate;
use rebounce_args::progress::{JSON_LINES, LINES, LastShown, Measured, ProgressLine, sentence};
use serde::Serialize;
use std::io::{IsTerminal, Write};
use std::sync::Mutex;

/// Steps of the bar.
const STEPS: u64 = 1000;

/// Output of progress.
pub enum Display {
    /// One bar on a terminal.
    Bar(ProgressBar),
    /// Lines on standard error, at stages and every ten seconds.
    Lines(Mutex<LastShown>),
    /// JSON objects on standard output, one a line.
    Json(Mutex<LastShown>),
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
                let Ok(mut last) = last.lock() else { return };
                if last.is_due(progress, LINES) {
                    eprintln!("{}", last.line(progress));
                }
            }
            Self::Json(last) => {
                let Ok(mut last) = last.lock() else { return };
                if last.is_due(progress, JSON_LINES) {
                    line(&last.json(progress));
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
            Self::Json(_) => {
                let measured = error.map(|ErrorEstimate { value, at_least, at_most }| Measured {
                    measured_error: value,
                    measured_error_at_least: at_least,
                    measured_error_at_most: at_most,
                });
                line(&ProgressLine::done(seconds, processor_seconds, measured));
            }
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
