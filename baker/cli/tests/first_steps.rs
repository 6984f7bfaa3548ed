//! First commands of a new user: help, the version, unbaked files and files of unsupported formats.

use program::{names, said};
use std::io::{BufRead, BufReader, Read};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, SystemTime};

use crate::common::program;

const VERBS: [&str; 8] = ["bake", "solve", "info", "render", "reference", "compare", "export", "view"];
/// A scene of few triangles.
const PLAIN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/gltf/plain.glb");

fn rebounce(folder: &Path, args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rebounce"));
    command.current_dir(folder).args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn done(args: &[&str]) -> String {
    let output = rebounce(Path::new("."), args).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", said(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// Asserts that a command fails with a message that contains `words`.
fn fails(output: &Output, words: &[&str]) {
    assert_eq!(output.status.code(), Some(1), "{}", said(output));
    for word in words {
        assert!(said(output).contains(word), "no {word}: {}", said(output));
    }
}

/// Long names of the options under a heading of a help text.
fn options(help: &str, heading: &str) -> Vec<String> {
    let lines = help.lines().skip_while(|line| *line != format!("{heading}:")).skip(1);
    let group = lines.take_while(|line| line.is_empty() || line.starts_with(' '));
    let option = |line: &str| {
        let (flags, rest) = line.strip_prefix("  ").map(str::trim_start)?.split_once("--")?;
        let name: String = rest.chars().take_while(|c| c.is_ascii_lowercase() || *c == '-').collect();
        let is_option =
            line.len() - line.trim_start().len() <= 6 && (flags.is_empty() || flags.starts_with('-'));
        (is_option && !name.is_empty()).then_some(name)
    };
    group.filter_map(option).collect()
}

#[test]
fn the_version_is_told_everywhere() {
    let version = env!("CARGO_PKG_VERSION");
    for flag in ["-v", "-V", "--version"] {
        assert_eq!(done(&[flag]).trim(), format!("rebounce {version}"));
        for verb in VERBS {
            assert!(done(&[verb, flag]).trim().ends_with(version), "{verb} {flag}");
        }
    }
}

#[test]
fn help_begins_with_nine_everyday_options_and_has_the_rest_in_groups() {
    let everyday =
        ["output", "preset", "target-error", "for", "shot", "viewpoint", "max-bytes", "preview", "resume"];
    let (short, long) = (done(&["bake", "-h"]), done(&["bake", "--help"]));
    for help in [&short, &long] {
        let options = options(help, "Options");
        assert_eq!(options[..9], everyday, "{help}");
        assert!(options[9..].iter().all(|name| ["help", "version"].contains(&name.as_str())), "{options:?}");
    }
    for (heading, name) in [
        ("The scene's file", "albedo"),
        ("Light from the sky", "environment"),
        ("Quality", "functions"),
        ("Limits", "max-memory"),
        ("Reports", "json-progress"),
    ] {
        assert!(options(&long, heading).iter().any(|option| option == name), "{heading}: {long}");
        assert!(!short.contains(&format!("--{name}")), "{short}");
    }
    assert!(short.lines().count() < 40 && short.contains("rebounce bake --help"), "{short}");
    assert!(long.contains("Exit codes") && !short.contains("Exit codes"));
    for verb in VERBS {
        assert!(done(&[verb, "-h"]).len() <= done(&[verb, "--help"]).len(), "{verb}");
    }
}

#[test]
fn files_of_other_formats_are_named_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str, contents: &[u8]| std::fs::write(folder.path().join(name), contents).unwrap();
    at("chair.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    at("room.fbx", b"Kaydara FBX Binary  \0\x1a\0");
    at("room.blend", b"BLENDER-v300");
    for (file, what) in [("chair.obj", "Wavefront OBJ"), ("room.fbx", "FBX"), ("room.blend", "Blender file")]
    {
        let output = rebounce(folder.path(), &["bake", file]).output().unwrap();
        fails(&output, &[file, what, "glTF 2.0", "Blender", "Export"]);
    }
    // A scene with a wrong file extension is still read.
    std::fs::copy(PLAIN, folder.path().join("plain.obj")).unwrap();
    let few = ["bake", "plain.obj", "--preset", "draft", "--functions", "200", "--levels", "2"];
    assert!(rebounce(folder.path(), &few).status().unwrap().success());
    let again = rebounce(folder.path(), &["bake", "plain.rbn"]).output().unwrap();
    fails(&again, &["plain.rbn is a baked file", "rebounce view plain.rbn", "to bake again"]);
}

/// Runs `view`, and returns the output until the server starts: the address, and the standard error; `None` if
/// `rebounce` was built without the viewer, as the error must state.
fn viewed(folder: &Path, args: &[&str]) -> Option<(String, String)> {
    let mut view = rebounce(folder, &["view", "--no-open", "--port", "0"]).args(args).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(view.stdout.take().unwrap()).read_line(&mut line).unwrap();
    // No effect if the process has ended by itself.
    let _ = view.kill();
    view.wait().unwrap();
    let mut told = String::new();
    view.stderr.take().unwrap().read_to_string(&mut told).unwrap();
    if told.contains("built without the viewer") {
        assert!(
            line.is_empty()
                && told.contains("cargo xtask web")
                && told.contains("cargo install --path baker")
        );
        return None;
    }
    Some((line, told))
}

#[test]
fn a_scene_is_baked_as_a_draft_before_it_is_viewed() {
    let temp = tempfile::tempdir().unwrap();
    let folder = temp.path();
    let modify = |name: &str, seconds: i64| {
        let ago = Duration::from_secs(seconds.unsigned_abs());
        let now = SystemTime::now();
        let when = if seconds < 0 { now - ago } else { now + ago };
        std::fs::File::options().write(true).open(folder.join(name)).unwrap().set_modified(when).unwrap();
    };
    std::fs::copy(PLAIN, folder.join("plain.glb")).unwrap();
    modify("plain.glb", -1000);
    let Some((line, told)) = viewed(folder, &["plain.glb"]) else { return };
    assert!(line.contains("plain.draft.rbn at http://127.0.0.1:"), "{line}{told}");
    assert!(told.contains("baking a draft of plain.glb into plain.draft.rbn"), "{told}");
    assert_eq!(names(folder), ["plain.draft.rbn", "plain.glb"]);
    let first = std::fs::read(folder.join("plain.draft.rbn")).unwrap();
    // The draft exists, and is replaced only for a newer scene.
    let (_, told) = viewed(folder, &["plain.glb", "--yes"]).unwrap();
    assert!(told.contains("baked already: plain.draft.rbn") && !told.contains("baking"), "{told}");
    modify("plain.draft.rbn", -2000);
    let (_, told) = viewed(folder, &["plain.glb", "--yes"]).unwrap();
    assert!(told.contains("baking a draft"), "{told}");
    // A newer bake by the user is shown, and never replaced.
    std::fs::copy(folder.join("plain.draft.rbn"), folder.join("plain.rbn")).unwrap();
    let (line, told) = viewed(folder, &["plain.glb"]).unwrap();
    assert!(line.starts_with("plain.rbn at") && told.contains("baked already: plain.rbn"), "{line}{told}");
    std::fs::write(folder.join("plain.rbn"), "the user's").unwrap();
    modify("plain.rbn", -3000);
    std::fs::write(folder.join("plain.draft.rbn"), "something else").unwrap();
    modify("plain.draft.rbn", -3000);
    let refused = rebounce(folder, &["view", "--no-open", "plain.glb"]).output().unwrap();
    fails(&refused, &["plain.draft.rbn is no draft", "move it"]);
    assert_eq!(std::fs::read(folder.join("plain.draft.rbn")).unwrap(), b"something else");
    assert_eq!(std::fs::read(folder.join("plain.rbn")).unwrap(), b"the user's");
    assert!(first.len() > 1000);
    // A failed bake ends the command, with the bake's error message.
    std::fs::write(folder.join("broken.gltf"), "{}").unwrap();
    let broken = rebounce(folder, &["view", "--no-open", "broken.gltf"]).output().unwrap();
    fails(&broken, &["broken.gltf"]);
    let unknown = rebounce(folder, &["view", "--no-open", "builtin:cornell"]).output().unwrap();
    fails(&unknown, &["no built-in scene `cornell`"]);
    assert!(!String::from_utf8_lossy(&unknown.stderr).contains("baking"), "a draft of nothing is announced");
    let missing = rebounce(folder, &["view", "--no-open", "missing.glb"]).output().unwrap();
    fails(&missing, &["cannot read missing.glb"]);
    std::fs::write(folder.join("chair.obj"), "v 0 0 0").unwrap();
    let other = rebounce(folder, &["view", "--no-open", "chair.obj"]).output().unwrap();
    fails(&other, &["Wavefront OBJ", "glTF 2.0"]);
}
