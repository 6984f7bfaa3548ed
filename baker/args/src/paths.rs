//! Paths of inputs and outputs: checks before long work.

use crate::error::ArgsError;
use rebounce::io::write::WriteError;
use rebounce::scene::SceneError;
use rebounce_shared::rbn::container::MAGIC;
use std::path::Path;

/// What the checks ask of the file system.
pub trait Places {
    /// Returns the first bytes of a regular file, `count` of them; `None` if it has fewer or cannot be read.
    fn first_bytes(&self, path: &Path, count: usize) -> Option<Vec<u8>>;

    /// Whether two paths name a single file.
    fn is_same(&self, a: &Path, b: &Path) -> bool;

    /// Checks in advance whether a file can be written.
    ///
    /// # Errors
    /// The reason why not.
    fn check_place(&self, path: &Path) -> Result<(), WriteError>;
}

/// The file system of this machine.
#[cfg(not(target_arch = "wasm32"))]
pub struct DiskPlaces;

#[cfg(not(target_arch = "wasm32"))]
impl Places for DiskPlaces {
    fn first_bytes(&self, path: &Path, count: usize) -> Option<Vec<u8>> {
        use std::io::Read;
        if !std::fs::metadata(path).ok()?.is_file() {
            return None;
        }
        let mut first = vec![0; count];
        std::fs::File::open(path).ok()?.read_exact(&mut first).ok()?;
        Some(first)
    }

    fn is_same(&self, a: &Path, b: &Path) -> bool {
        a == b || a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
    }

    fn check_place(&self, path: &Path) -> Result<(), WriteError> {
        rebounce::io::write::check_place(path)
    }
}

/// Checks that `path` has the ending and can be written; `what` names the file in errors.
fn check_output(
    places: &dyn Places,
    path: &Path,
    ending: &'static str,
    what: &'static str,
) -> Result<(), ArgsError> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending)) {
        return Err(ArgsError::Ending { path: path.to_owned(), what, ending });
    }
    Ok(places.check_place(path)?)
}

/// Checks the paths before long work: the outputs can be written, and overwrite no input.
///
/// # Errors
/// A message about the problem.
pub fn check_paths(
    places: &dyn Places,
    scene: &str,
    shot: Option<&Path>,
    output: &Path,
    report: Option<&Path>,
) -> Result<(), ArgsError> {
    if places.first_bytes(Path::new(scene), MAGIC.len()).is_some_and(|first| first == MAGIC) {
        return Err(SceneError::Baked { file: scene.to_owned() }.into());
    }
    check_output(places, output, "rbn", "what is baked")?;
    if let Some(report) = report {
        check_output(places, report, "json", "the report")?;
    }
    let read = [Some((Path::new(scene), "the scene")), shot.map(|shot| (shot, "the shot"))];
    for written in [Some(output), report].into_iter().flatten() {
        for (path, what) in read.into_iter().flatten() {
            if places.is_same(path, written) {
                return Err(ArgsError::Overwrites { path: written.to_owned(), what });
            }
        }
    }
    Ok(())
}
