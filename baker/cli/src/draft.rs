//! Draft of a scene, baked for `rebounce view`.

use super::read_baked;
use anyhow::{Context, Result, bail, ensure};
use rebounce::demo;
use rebounce::io::is_step;
use std::io::{self, BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::SystemTime;

/// File extension of drafts, beside the scene.
const DRAFT: &str = "draft.rbn";
/// The preset of drafts.
const PRESET: &str = "draft";

/// Outcome of finding or baking a file to show.
pub enum Draft {
    /// Baked file to show.
    Shown(PathBuf),
    /// No file to show; the process ends with the exit code.
    Not(ExitCode),
}

/// Returns the baked file to show: `file`, unless a scene. For a scene, returns an existing bake or draft that is not
/// older, or else bakes a draft, after a question if a user is at the terminal.
///
/// # Errors
/// If the scene cannot be read, or a different file occupies the path of the draft.
pub fn of(file: &Path, is_watching: bool, yes: bool) -> Result<Draft> {
    let Some(builtin) = scene_kind(file) else { return Ok(Draft::Shown(file.to_owned())) };
    let scene = file.display();
    // Report a wrong name before announcing a draft.
    if let Some(name) = file.to_str().and_then(|file| file.strip_prefix("builtin:")) {
        demo::check(name)?;
    }
    ensure!(!is_watching, "--watch is for baked files: give the .rbn that {scene} is baked into");
    // A built-in scene is as old as the program.
    let source = if builtin { std::env::current_exe()? } else { file.to_owned() };
    let since = modified(&source).with_context(|| format!("cannot read {}", source.display()))?;
    let [own, draft] = places(file, builtin);
    for there in [&own, &draft] {
        if modified(there).is_ok_and(|made| made >= since) {
            eprintln!("{scene} is baked already: {}", there.display());
            return Ok(Draft::Shown(there.clone()));
        }
    }
    if draft.exists() && !is_draft(&draft) {
        bail!(
            "a draft of {scene} would go into {0}, and {0} is no draft: move it, or bake the scene with `rebounce bake {scene} -o FILE.rbn`",
            draft.display()
        );
    }
    let is_asked = !yes && io::stdin().is_terminal() && io::stderr().is_terminal();
    if is_asked
        && !agrees(
            &format!("{scene} is not baked yet. Bake a draft into {}?", draft.display()),
            &mut io::stdin().lock(),
        )?
    {
        eprintln!("`rebounce bake {scene}` makes a finer bake than a draft");
        return Ok(Draft::Not(ExitCode::SUCCESS));
    }
    eprintln!(
        "baking a draft of {scene} into {}; `rebounce bake {scene}` makes a finer one",
        draft.display()
    );
    bake(file, draft)
}

/// Whether a scene is built in; `None` if `file` is no scene.
pub fn scene_kind(file: &Path) -> Option<bool> {
    if file.to_str().is_some_and(|name| name.starts_with("builtin:")) {
        return Some(true);
    }
    let ending = file.extension()?;
    let is_gltf = ending.eq_ignore_ascii_case("glb") || ending.eq_ignore_ascii_case("gltf");
    (is_gltf || is_step(file)).then_some(false)
}

/// Paths of a scene's bake and draft: beside the scene, or in the working folder.
fn places(file: &Path, builtin: bool) -> [PathBuf; 2] {
    let name = file.to_str().and_then(|name| name.strip_prefix("builtin:")).filter(|_| builtin);
    let stem = name.map_or_else(|| file.to_owned(), PathBuf::from);
    ["rbn", DRAFT].map(|ending| stem.with_extension(ending))
}

fn modified(path: &Path) -> io::Result<SystemTime> {
    path.metadata()?.modified()
}

/// Whether a file is a bake with the preset of drafts.
fn is_draft(path: &Path) -> bool {
    read_baked(path).is_ok_and(|(_, scene)| scene.meta.bake.preset == PRESET)
}

/// Asks a question on standard error; returns whether the answer is yes or an empty line.
fn agrees(question: &str, answers: &mut impl BufRead) -> io::Result<bool> {
    eprint!("{question} [Y/n] ");
    io::stderr().flush()?;
    let mut line = String::new();
    let is_answered = answers.read_line(&mut line)? > 0;
    Ok(is_answered && matches!(line.trim().to_lowercase().as_str(), "" | "y" | "yes"))
}

/// Bakes in a child process, which shows the progress and receives Ctrl-C. Standard output is reserved for the address.
fn bake(scene: &Path, draft: PathBuf) -> Result<Draft> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(["bake", "--preset", PRESET, "-o"]).arg(&draft).arg("--").arg(scene);
    command.stdout(Stdio::from(io::stderr()));
    let status = command.status().context("starting the bake")?;
    if status.success() {
        return Ok(Draft::Shown(draft));
    }
    // The child has printed the error.
    let code = status.code().and_then(|code| u8::try_from(code).ok());
    Ok(Draft::Not(code.map_or(ExitCode::FAILURE, ExitCode::from)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_known_by_their_names() {
        let kind = |name: &str| scene_kind(Path::new(name));
        assert_eq!(
            (kind("a/room.glb"), kind("ROOM.GLTF"), kind("part.STP"), kind("builtin:library")),
            (Some(false), Some(false), Some(false), Some(true))
        );
        assert_eq!((kind("room.rbn"), kind("room.obj"), kind("room"), kind("glb")), (None, None, None, None));
        let [own, draft] = places(Path::new("a/room.v2.glb"), false);
        assert_eq!((own, draft), ("a/room.v2.rbn".into(), "a/room.v2.draft.rbn".into()));
        assert_eq!(places(Path::new("builtin:library"), true)[1], PathBuf::from("library.draft.rbn"));
    }

    #[test]
    fn yes_is_said_or_an_empty_line_and_silence_is_no() {
        let asked = |answer: &str| agrees("Bake?", &mut answer.as_bytes()).unwrap();
        assert!(asked("\n") && asked("y\n") && asked("Yes\n"));
        assert!(!asked("n\n") && !asked("what\n") && !asked(""));
    }
}
