//! Atomic file writes on a disk.

use super::WriteError;
use std::fs::File;
use std::io::Write;
use std::path::Path;
use xxhash_rust::xxh32::xxh32;

/// The folder of a file.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Checks in advance, before a long computation, whether a file can be written to `path`.
///
/// # Errors
/// [`WriteError`]; the file system is unchanged.
pub fn check_place(path: &Path) -> Result<(), WriteError> {
    check_kind(path)?;
    let folder = folder_of(path);
    if !folder.is_dir() {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        return Err(WriteError::NoFolder { folder: folder.to_owned(), name });
    }
    let attempt = tempfile::Builder::new().prefix(&prefix(path)).tempfile_in(folder);
    attempt.map(drop).map_err(|error| WriteError::Folder {
        folder: folder.to_owned(),
        // The error without the name of the temporary file, meaningless to users.
        source: error.kind().into(),
    })
}

/// Accepts only regular files and free paths as targets: a device or a folder is never replaced.
fn check_kind(path: &Path) -> Result<(), WriteError> {
    match path.metadata() {
        Ok(found) if !found.is_file() => Err(WriteError::NotAFile(path.to_owned())),
        _ if path.file_name().is_none() => Err(WriteError::NotAFile(path.to_owned())),
        _ => Ok(()),
    }
}

/// Writes `bytes` to a temporary file in the same folder, flushes the file to disk, renames it to
/// `path` and flushes the folder. Removes stale temporary files of `path`, left by killed
/// processes.
///
/// # Errors
/// [`WriteError`]; the temporary file is removed and `path` is untouched.
pub fn write_whole(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    check_kind(path)?;
    let attempt = || {
        let folder = folder_of(path);
        let prefix = prefix(path);
        remove_stale(folder, &prefix);
        let mut file = tempfile::Builder::new().prefix(&prefix).tempfile_in(folder)?;
        // Marks the file as in use; without support for locks, no file ever counts as stale.
        let _ = file.as_file().try_lock();
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        #[cfg(unix)]
        {
            // Temporary files are private: the result needs the permissions of an ordinary new
            // file.
            use std::os::unix::fs::PermissionsExt;
            let mode = std::fs::metadata(path).map_or(0o644, |m| m.permissions().mode());
            file.as_file().set_permissions(std::fs::Permissions::from_mode(mode))?;
        }
        file.persist(path).map_err(|error| error.error)?;
        // The new name must survive a power failure; the file is complete either way where folders
        // cannot be flushed.
        #[cfg(unix)]
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
        Ok(())
    };
    attempt().map_err(|source| WriteError::Failed { path: path.to_owned(), source })
}

/// Name prefix of the temporary files of a path.
fn prefix(path: &Path) -> String {
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    format!(".rebounce-{:08x}-", xxh32(name.as_bytes(), 0))
}

/// Removes unlocked temporary files. Unreadable or undeletable files remain: they only waste space.
fn remove_stale(folder: &Path, prefix: &str) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let is_ours = entry.file_name().to_string_lossy().starts_with(prefix)
            && entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_ours && File::options().write(true).open(entry.path()).is_ok_and(|file| file.try_lock().is_ok())
        {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.rbn");
        write_whole(&path, b"old").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
        write_whole(&path, b"new").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"new");
        assert!(write_whole(&folder.path().join("none/a.rbn"), b"x").is_err());
        assert!(write_whole(folder.path(), b"x").is_err());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
    #[test]
    fn places_where_nothing_can_be_written_are_told_before() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.rbn");
        assert!(check_place(&path).is_ok());
        std::fs::write(&path, "old").unwrap();
        assert!(check_place(&path).is_ok());
        let refused = |path: &Path| check_place(path).unwrap_err().to_string();
        assert!(refused(folder.path()).contains("not a file"));
        assert!(refused(&folder.path().join("none/a.rbn")).contains("no folder"));
        assert!(refused(Path::new("/")).contains("not a file"));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
        assert_eq!(std::fs::read(&path).unwrap(), b"old");
    }

    #[test]
    fn what_a_killed_process_left_is_removed_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let path = at("a.rbn");
        let (stale, other) = (prefix(&path) + "x1y2z3", prefix(&at("b.rbn")) + "x1y2z3");
        let held = prefix(&path) + "held00";
        for name in [&stale, &other, &held] {
            std::fs::write(at(name), "half").unwrap();
        }
        std::fs::create_dir(at(&(prefix(&path) + "folder"))).unwrap();
        let by_another = File::open(at(&held)).unwrap();
        by_another.lock().unwrap();
        write_whole(&path, b"new").unwrap();
        assert!(!at(&stale).exists(), "left by a killed process");
        assert!(at(&other).exists() && at(&held).exists(), "another output's, and one that is being written");
        assert!(at(&(prefix(&path) + "folder")).is_dir());
        drop(by_another);
        write_whole(&path, b"newer").unwrap();
        assert!(!at(&held).exists() && at(&other).exists());
        assert_eq!(std::fs::read(&path).unwrap(), b"newer");
    }
}
