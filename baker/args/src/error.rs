//! Errors of what the arguments name, and the sentence that a command prints of an error.

use rebounce::bake::budget::BudgetError;
use rebounce::io::environment::EnvironmentError;
use rebounce::io::shot::ShotError;
use rebounce::io::write::WriteError;
use rebounce::scene::SceneError;
use std::path::PathBuf;

/// Reason why a bake cannot begin with these arguments.
#[derive(Debug, thiserror::Error)]
pub enum ArgsError {
    /// The scene cannot be loaded.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// More places than files to put there.
    #[error("--at is given {places} times, and --add {files}: give each file its place, or none")]
    Places {
        /// Files of `--add`.
        files: usize,
        /// Places of `--at`.
        places: usize,
    },
    /// The picture of `--environment` cannot be used.
    #[error(transparent)]
    Environment(#[from] EnvironmentError),
    /// Every pixel of the environment is black.
    #[error("the environment is black")]
    Black,
    /// An option that a file for an environment cannot have.
    #[error("--for environment bakes an operator and keeps the light of the sky alone: leave out {0}")]
    ForEnvironment(&'static str),
    /// An output has the ending of other files.
    #[error("{path}: {what} is a .{ending} file: give a name that ends in .{ending}")]
    Ending {
        /// The output.
        path: PathBuf,
        /// What is written there.
        what: &'static str,
        /// The ending of such files.
        ending: &'static str,
    },
    /// An output is an input.
    #[error("{path} is {what} and would be overwritten: give another name")]
    Overwrites {
        /// The output.
        path: PathBuf,
        /// What is read there.
        what: &'static str,
    },
    /// An output cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// The shot cannot be used.
    #[error(transparent)]
    Shot(#[from] ShotError),
    /// No preset is made for the error of `--target-error`.
    #[error(transparent)]
    Target(BudgetError),
    /// The scene does not fit the budget.
    #[error("{scene}: {source}")]
    Budget {
        /// The scene, as it was given.
        scene: String,
        /// The budget, and what fits it.
        source: BudgetError,
    },
}

/// Joins an error and its causes, outermost first; skips causes that the text of earlier errors contains.
pub fn sentence<'a>(chain: impl Iterator<Item = &'a (dyn std::error::Error + 'static)>) -> String {
    chain.fold(String::new(), |said, cause| {
        let cause = cause.to_string();
        match () {
            () if said.is_empty() => cause,
            () if said.contains(&cause) => said,
            () => format!("{said}: {cause}"),
        }
    })
}
