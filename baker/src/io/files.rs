//! Where the bytes of a scene come from: a disk, or memory (an archive, files dropped on a page).

use std::collections::BTreeMap;
use std::io::{Error, ErrorKind, Result};
use std::path::{Component, Path, PathBuf};

/// A source of files, by path.
pub trait Files: Sync {
    /// Reads a whole file.
    ///
    /// # Errors
    /// If there is no such file, or the file cannot be read.
    fn read(&self, path: &Path) -> Result<Vec<u8>>;

    /// Whether there is a file or a folder at this path.
    fn exists(&self, path: &Path) -> bool;

    /// Returns the names of the files and folders in a folder (empty: the root), in any order; empty if unknown. A name
    /// written in other letters is looked up by this list.
    fn names(&self, folder: &Path) -> Vec<String>;
}

/// Files of this machine. Relative paths start at the working directory.
#[derive(Clone, Copy, Debug, Default)]
pub struct Disk;

impl Files for Disk {
    fn read(&self, path: &Path) -> Result<Vec<u8>> {
        std::fs::read(path)
    }

    fn exists(&self, path: &Path) -> bool {
        path.exists()
    }

    fn names(&self, folder: &Path) -> Vec<String> {
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect()
    }
}

/// Files in memory, by path from the root: `models/room.gltf`.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    files: BTreeMap<PathBuf, Vec<u8>>,
}

impl Memory {
    /// Adds a file, or replaces the file of this path.
    pub fn insert(&mut self, path: impl AsRef<Path>, bytes: Vec<u8>) {
        self.files.insert(normal(path.as_ref()), bytes);
    }
}

impl<P: AsRef<Path>> FromIterator<(P, Vec<u8>)> for Memory {
    fn from_iter<I: IntoIterator<Item = (P, Vec<u8>)>>(files: I) -> Self {
        let mut all = Self::default();
        files.into_iter().for_each(|(path, bytes)| all.insert(path, bytes));
        all
    }
}

impl Files for Memory {
    fn read(&self, path: &Path) -> Result<Vec<u8>> {
        self.files.get(&normal(path)).cloned().ok_or_else(|| Error::from(ErrorKind::NotFound))
    }

    fn exists(&self, path: &Path) -> bool {
        let path = normal(path);
        self.files.keys().any(|file| file.starts_with(&path))
    }

    fn names(&self, folder: &Path) -> Vec<String> {
        let folder = normal(folder);
        let within = self.files.keys().filter_map(|file| file.strip_prefix(&folder).ok());
        let first = within.filter_map(|rest| rest.components().next());
        first.map(|name| name.as_os_str().to_string_lossy().into_owned()).collect()
    }
}

/// Removes `.`, `..` and the root of a path.
fn normal(path: &Path) -> PathBuf {
    let mut normal = PathBuf::new();
    for part in path.components() {
        match part {
            Component::Normal(name) => normal.push(name),
            Component::ParentDir => {
                normal.pop();
            }
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    normal
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_finds_files_and_folders_by_any_spelling_of_their_path() {
        let files: Memory = [("a/room.gltf", vec![1]), ("./a/../b/oak.png", vec![2])].into_iter().collect();
        assert_eq!(files.read(Path::new("/a/./room.gltf")).unwrap(), [1]);
        assert_eq!(files.read(Path::new("a/../b/oak.png")).unwrap(), [2]);
        assert_eq!(files.read(Path::new("b")).unwrap_err().kind(), ErrorKind::NotFound);
        assert!(files.exists(Path::new("b")) && !files.exists(Path::new("c")));
        assert_eq!(
            (files.names(Path::new("")), files.names(Path::new("b"))),
            (vec!["a".into(), "b".into()], vec!["oak.png".into()])
        );
    }
}
