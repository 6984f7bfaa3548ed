//! Atomic file writes: the complete file, or no change. On wasm32-unknown-unknown, which has no files, every write fails.

#[cfg(not(target_arch = "wasm32"))]
mod disk;

#[cfg(target_arch = "wasm32")]
use std::path::Path;
use std::path::PathBuf;

#[cfg(not(target_arch = "wasm32"))]
pub use disk::{check_place, write_whole};

/// Reason for a failed write. The previous file at the path is intact.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// I/O error.
    #[error("{path}: {source}; the file is as it was before")]
    Failed {
        /// The file that was to be written.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The path names a folder or a device.
    #[error("{0} is a folder or a device, not a file: give another name")]
    NotAFile(PathBuf),
    /// The folder does not exist.
    #[error("there is no folder {folder} to write {name} to: make it, or give another one")]
    NoFolder {
        /// The folder.
        folder: PathBuf,
        /// The file's name in it.
        name: String,
    },
    /// The folder is not writable.
    #[error("nothing can be written to the folder {folder}: {source}")]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
}

/// Checks in advance whether a file can be written: never here.
///
/// # Errors
/// Always.
#[cfg(target_arch = "wasm32")]
pub fn check_place(path: &Path) -> Result<(), WriteError> {
    write_whole(path, &[])
}

/// Writes a file: never here.
///
/// # Errors
/// Always.
#[cfg(target_arch = "wasm32")]
pub fn write_whole(path: &Path, _bytes: &[u8]) -> Result<(), WriteError> {
    Err(WriteError::Failed { path: path.to_owned(), source: std::io::ErrorKind::Unsupported.into() })
}
