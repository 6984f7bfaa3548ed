//! A draft of a scene, baked so that there is something to view.

use super::read_baked;
use anyhow::{Context, Result, bail, ensure};
use rebounce::scene::builtin;
use std::io::{self, BufRead, IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::SystemTime;

/// What drafts end with, beside their scene.
const DRAFT: &str = "draft.rbn";
/// The preset of drafts.
const PRESET: &str = "draft";

/// The outcome.
pub enum Draft {
    /// This baked file is to be shown.
    Shown(PathBuf),
    /// None is; the process ends so.
    Not(ExitCode),
}

/// The baked file to show: the file itself, unless it is a scene. Of a scene, the bake or the draft that is there already and
/// not older, or a draft that is baked now, after a question where somebody can answer it.
///
/// # Errors
/// Where the scene cannot be read, or where another file lies in the draft's place.
pub fn of(file: &Path, is_watching: bool, yes: bool) -> Result<Draft> {
    let Some(builtin) = scene_kind(file) else { return Ok(Draft::Shown(file.to_owned())) };
    let scene = file.display();
    // A wrong name is told before a draft is announced.
    if let Some(name) = file.to_str().and_then(|file| file.strip_prefix("builtin:")) {
        builtin::check(name)?;
    }
    ensure!(!is_watching, "--watch is for baked files: give the .rbn that {scene} is baked into");
    // What is built in is as old as the program.
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

/// Whether a file is a scene, and then whether a built-in one.
fn scene_kind(file: &Path) -> Option<bool> {
    if file.to_str().is_some_and(|name| name.starts_with("builtin:")) {
        return Some(true);
    }
    let ending = file.extension()?;
    (ending.eq_ignore_ascii_case("glb") || ending.eq_ignore_ascii_case("gltf")).then_some(false)
}

/// Where a bake of a scene lies and where its draft goes: beside it, or in the working folder.
fn places(file: &Path, builtin: bool) -> [PathBuf; 2] {
    let name = file.to_str().and_then(|name| name.strip_prefix("builtin:")).filter(|_| builtin);
    let stem = name.map_or_else(|| file.to_owned(), PathBuf::from);
    ["rbn", DRAFT].map(|ending| stem.with_extension(ending))
}

fn modified(path: &Path) -> io::Result<SystemTime> {
    path.metadata()?.modified()
}

/// Whether a file is a bake of the drafts' preset.
fn is_draft(path: &Path) -> bool {
    read_baked(path).is_ok_and(|(_, scene)| scene.meta.bake.preset == PRESET)
}

/// Asks a question on standard error; whether the answer is yes, which an empty line is.
fn agrees(question: &str, answers: &mut impl BufRead) -> io::Result<bool> {
    eprint!("{question} [Y/n] ");
    io::stderr().flush()?;
    let mut line = String::new();
    let is_answered = answers.read_line(&mut line)? > 0;
    Ok(is_answered && matches!(line.trim().to_lowercase().as_str(), "" | "y" | "yes"))
}

/// Bakes in a process of its own, which shows its progress and hears of Ctrl-C. Standard output is left to the address.
fn bake(scene: &Path, draft: PathBuf) -> Result<Draft> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(["bake", "--preset", PRESET, "-o"]).arg(&draft).arg("--").arg(scene);
    command.stdout(Stdio::from(io::stderr()));
    let status = command.status().context("starting the bake")?;
    if status.success() {
        return Ok(Draft::Shown(draft));
    }
    // It has said why.
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
            (kind("a/room.glb"), kind("ROOM.GLTF"), kind("builtin:library")),
            (Some(false), Some(false), Some(true))
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
