//! Checkpoint of a bake: a file beside the output with the finished work, so that a stopped or killed bake can resume.
//!
//! * [`identity`] – the inputs of the result;
//! * [`record`] – the file's records.
//!
//! The file is append-only. A record cut short by a kill does not match its checksum and is removed before the bake
//! resumes. A dedicated thread writes, and forces the written data to disk every few seconds.

mod identity;
mod record;
mod writer;

pub use identity::Identity;
pub use writer::Storage;

use super::partial_results::PartialResults;
use record::Record;
use std::collections::HashMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use writer::Writer;

/// Reason for an unusable checkpoint.
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    /// The file cannot be read or written.
    #[error("{path}: {source}; what was kept there before is whole, and --resume goes on from it")]
    Io {
        /// Path of the checkpoint.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// Another process uses the file.
    #[error("{0} is in use by another bake: wait for that one, or write elsewhere with --output")]
    Busy(PathBuf),
    /// The file is no checkpoint.
    #[error("{0} is no checkpoint of a bake: remove it, or bake without --resume, which replaces it")]
    Foreign(PathBuf),
    /// The checkpoint belongs to another scene or to other settings.
    #[error(
        "{path} is of another bake ({difference}): give the same scene and settings to go on with that one, or leave --resume out to begin anew"
    )]
    Other {
        /// Path of the checkpoint.
        path: PathBuf,
        /// Difference between the checkpoint's identity and the requested identity.
        difference: String,
    },
}

/// Records of an earlier run, by kind and key.
#[derive(Default)]
struct Saved {
    parts: HashMap<(u32, u64), Vec<u8>>,
    records: usize,
}

/// Checkpoint of a bake, open and locked; written until dropped.
pub struct Checkpoint {
    path: PathBuf,
    salt: u32,
    saved: Mutex<Saved>,
    writer: Writer,
}

impl Checkpoint {
    /// Begins a checkpoint; replaces an existing checkpoint.
    ///
    /// # Errors
    /// [`CheckpointError`].
    pub fn create(path: &Path, identity: &Identity) -> Result<Self, CheckpointError> {
        let file = open(path)?;
        Self::begin(path, file, identity)
    }

    /// Resumes from a checkpoint; begins a checkpoint if the file is new.
    ///
    /// # Errors
    /// [`CheckpointError`], also for the checkpoint of another bake, which stays unchanged.
    pub fn resume(path: &Path, identity: &Identity) -> Result<Self, CheckpointError> {
        let io = |source| CheckpointError::Io { path: path.to_owned(), source };
        let mut file = open(path)?;
        let length = file.metadata().map_err(io)?.len();
        let mut from = BufReader::with_capacity(1 << 20, &file);
        let Some((first, mut end)) = record::read(&mut from, length, 0).map_err(io)? else {
            // Either killed before the first record was written, or no checkpoint.
            drop(from);
            file.rewind().map_err(io)?;
            let mut start = Vec::new();
            (&file).take(length.min(1 << 20)).read_to_end(&mut start).map_err(io)?;
            return match record::identity(&identity.to_json()).starts_with(&start) {
                true => Self::begin(path, file, identity),
                false => Err(CheckpointError::Foreign(path.to_owned())),
            };
        };
        let found = match &first {
            Record::Identity(json) => serde_json::from_slice::<Identity>(json).ok(),
            _ => None,
        };
        let found = found.ok_or_else(|| CheckpointError::Foreign(path.to_owned()))?;
        if let Some(difference) = found.difference(identity) {
            return Err(CheckpointError::Other { path: path.to_owned(), difference });
        }
        let salt = record::checksum_in(&record::identity(&identity.to_json()));
        let mut saved = Saved::default();
        while let Some((record, bytes)) = record::read(&mut from, length - end, salt).map_err(io)? {
            end += bytes;
            saved.records += 1;
            if let Record::Part { kind, key, bytes } = record {
                saved.parts.insert((kind, key), bytes);
            }
        }
        drop(from);
        file.set_len(end).map_err(io)?;
        file.seek(SeekFrom::Start(end)).map_err(io)?;
        let writer = Writer::new(Box::new(file), end);
        Ok(Self { path: path.to_owned(), salt, saved: Mutex::new(saved), writer })
    }

    fn begin(path: &Path, file: File, identity: &Identity) -> Result<Self, CheckpointError> {
        let io = |source| CheckpointError::Io { path: path.to_owned(), source };
        file.set_len(0).map_err(io)?;
        (&file).rewind().map_err(io)?;
        Ok(Self::on(Box::new(file), path, identity))
    }

    /// Creates a checkpoint on an empty storage; errors name `path`.
    pub fn on(storage: Box<dyn Storage>, path: &Path, identity: &Identity) -> Self {
        let first = record::identity(&identity.to_json());
        let salt = record::checksum_in(&first);
        let writer = Writer::new(storage, 0);
        writer.append(first);
        Self { path: path.to_owned(), salt, saved: Mutex::default(), writer }
    }

    /// Returns the path of the checkpoint.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns the number of records found at opening, without the first record.
    pub fn records_found(&self) -> usize {
        self.saved.lock().map_or(0, |saved| saved.records)
    }

    /// Returns whether writing has failed; [`Self::flush`] returns the error.
    pub fn has_failed(&self) -> bool {
        self.writer.has_failed()
    }

    /// Waits until all records are on disk.
    ///
    /// # Errors
    /// [`CheckpointError::Io`] if writing failed, now or before.
    pub fn flush(&self) -> Result<(), CheckpointError> {
        self.writer.flush().map_err(|source| CheckpointError::Io { path: self.path.clone(), source })
    }

    /// Ends writing and removes the file after a finished bake.
    pub fn remove(self) {
        drop(self.writer);
        // A leftover file only takes disk space.
        let _ = std::fs::remove_file(&self.path);
    }
}

impl PartialResults for Checkpoint {
    fn take(&self, kind: u32, key: u64) -> Option<Vec<u8>> {
        self.saved.lock().ok()?.parts.remove(&(kind, key))
    }

    fn keep(&self, kind: u32, key: u64, bytes: &[u8]) {
        self.writer.append(record::part(self.salt, kind, key, bytes));
    }
}

/// Opens and locks a checkpoint for this process.
fn open(path: &Path) -> Result<File, CheckpointError> {
    let io = |source| CheckpointError::Io { path: path.to_owned(), source };
    let file =
        OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(io)?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(CheckpointError::Busy(path.to_owned())),
        // The file system has no locks.
        Err(TryLockError::Error(error)) if error.kind() == io::ErrorKind::Unsupported => Ok(file),
        Err(TryLockError::Error(error)) => Err(io(error)),
    }
}
