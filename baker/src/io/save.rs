//! Saving of baked files.

use super::write::{WriteError, write_whole};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::rbn::RbnError;
use std::path::{Path, PathBuf};

/// Reason for a file that was not saved.
#[derive(Debug, thiserror::Error)]
pub enum SaveError {
    /// The contents do not fit the format.
    #[error("{path}: {source}")]
    Format {
        /// The file.
        path: PathBuf,
        /// Description of the problem.
        source: RbnError,
    },
    /// The file cannot be written.
    #[error("cannot write {0}")]
    Write(#[from] WriteError),
}

/// Saves a baked scene as a .rbn file. An existing file is replaced at once, or stays as it is.
///
/// # Errors
/// [`SaveError`].
pub fn save(path: impl AsRef<Path>, scene: &BakedScene) -> Result<(), SaveError> {
    let path = path.as_ref();
    let bytes = scene.to_bytes().map_err(|source| SaveError::Format { path: path.to_owned(), source })?;
    Ok(write_whole(path, &bytes)?)
}
