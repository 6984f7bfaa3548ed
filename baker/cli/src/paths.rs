//! Paths of inputs and outputs: checks before long work.

use anyhow::{Result, bail, ensure};
use rebounce::io::write::check_place;
use rebounce::scene::SceneError;
use rebounce_shared::rbn::container::MAGIC;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Whether two paths name a single file.
fn is_same(a: &Path, b: &Path) -> bool {
    a == b || a.canonicalize().is_ok_and(|a| b.canonicalize().is_ok_and(|b| a == b))
}

/// Checks that `path` has the ending and can be written; `what` names the file in errors.
fn check_output(path: &Path, ending: &str, what: &str) -> Result<()> {
    if !path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending)) {
        bail!("{}: {what} is a .{ending} file: give a name that ends in .{ending}", path.display());
    }
    Ok(check_place(path)?)
}

/// Whether a file begins with the magic of .rbn files.
fn is_baked(path: &Path) -> bool {
    let mut first = [0; MAGIC.len()];
    let file = std::fs::metadata(path).is_ok_and(|entry| entry.is_file()).then(|| File::open(path));
    file.is_some_and(|file| file.is_ok_and(|mut file| file.read_exact(&mut first).is_ok())) && first == MAGIC
}

/// Returns the path of the baked file: the `given` one, or the scene's name with .rbn in the working folder.
pub fn output_of(scene: &str, given: Option<&Path>) -> PathBuf {
    let name = || PathBuf::from(scene.rsplit([':', '/', '\\']).next().unwrap_or("scene"));
    given.map_or_else(|| name().with_extension("rbn"), Path::to_owned)
}

/// Checks the paths before long work: the outputs can be written, and overwrite no input.
///
/// # Errors
/// A message about the problem.
pub fn check_paths(scene: &str, shot: Option<&Path>, output: &Path, report: Option<&Path>) -> Result<()> {
    if is_baked(Path::new(scene)) {
        return Err(SceneError::Baked { file: scene.to_owned() }.into());
    }
    check_output(output, "rbn", "what is baked")?;
    if let Some(report) = report {
        check_output(report, "json", "the report")?;
    }
    let read = [Some((Path::new(scene), "the scene")), shot.map(|shot| (shot, "the shot"))];
    for written in [Some(output), report].into_iter().flatten() {
        for (path, what) in read.into_iter().flatten() {
            ensure!(
                !is_same(path, written),
                "{} is {what} and would be overwritten: give another name",
                written.display()
            );
        }
    }
    Ok(())
}
