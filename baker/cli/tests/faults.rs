//! The command with full disks, unwritable folders and missing inputs: an error message, and unchanged files.
#![cfg(unix)]

use program::{goes_on_to, held, names, said};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Command, Output, Stdio};

use crate::common::program;

fn rebounce(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rebounce"));
    command.args(args).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn bake(scene: &str, output: &Path, more: &[&str]) -> Command {
    let mut command = rebounce(&["bake", scene, "--functions", "200", "--levels", "3", "--rays", "64", "-o"]);
    command.arg(output).args(more);
    command
}

/// The command with file size limited to `blocks` blocks of 512 bytes; the limit's signal (SIGXFSZ) is ignored:
/// writing fails as on a full disk.
fn with_little_room(blocks: u32, command: &Command) -> Output {
    let mut limited = Command::new("sh");
    limited.args(["-c", &format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$@\""), "sh"]);
    limited.arg(command.get_program()).args(command.get_args()).output().unwrap()
}

/// Asserts failure with a message that contains `words`.
fn fails(output: &Output, words: &[&str]) {
    assert_eq!(output.status.code(), Some(1), "{}", said(output));
    for word in words {
        assert!(said(output).contains(word), "{word}: {}", said(output));
    }
    assert!(!said(output).contains("panicked"), "{}", said(output));
}

#[test]
fn a_disk_that_is_full_at_the_last_write_keeps_the_old_file_and_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.rbn");
    // A folder replaces the file: the bake finishes and is kept, only the last write fails.
    let child = held(|| bake("builtin:cornell-box", &path, &[]).spawn().unwrap(), &path, 1);
    std::fs::create_dir_all(path.join("inside")).unwrap();
    fails(
        &goes_on_to(child, "CONT"),
        &["the bake is done but not written", "room.rbn.partial has it for --resume"],
    );
    assert!(path.join("inside").is_dir());
    std::fs::remove_dir_all(&path).unwrap();
    std::fs::write(&path, "the old one").unwrap();
    let resume = bake("builtin:cornell-box", &path, &["--resume"]);
    fails(&with_little_room(8, &resume), &["not written", "the file is as it was before"]);
    assert_eq!(std::fs::read(&path).unwrap(), b"the old one");
    assert_eq!(names(folder.path()), ["room.rbn", "room.rbn.partial"], "nothing half written is left");
    let output = bake("builtin:cornell-box", &path, &["--resume"]).output().unwrap();
    assert!(output.status.success() && said(&output).contains("going on from"), "{}", said(&output));
    assert_eq!(names(folder.path()), ["room.rbn"]);
    // Pictures are written by the same code.
    let (shot, picture) = (folder.path().join("shot.json"), folder.path().join("out.png"));
    std::fs::write(
        &shot,
        r#"{"size": [64, 64], "camera": {"position": [0.1, 1, 3], "target": [0, 1, 0]},
            "lights": [{"type": "point", "position": [0, 1.5, 0.3], "intensity": 9}]}"#,
    )
    .unwrap();
    std::fs::write(&picture, "the old one").unwrap();
    let mut render = rebounce(&["render"]);
    render.arg(&path).arg("--shot").arg(&shot).arg("-o").arg(&picture);
    fails(&with_little_room(1, &render), &["out.png", "the file is as it was before"]);
    assert_eq!(std::fs::read(&picture).unwrap(), b"the old one");
    assert_eq!(names(folder.path()), ["out.png", "room.rbn", "shot.json"]);
    assert!(render.output().unwrap().status.success());
    assert!(std::fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn a_folder_that_cannot_be_written_is_told_before_the_bake_begins() {
    use std::os::unix::fs::PermissionsExt;
    let folder = tempfile::tempdir().unwrap();
    let closed = folder.path().join("closed");
    std::fs::create_dir(&closed).unwrap();
    std::fs::write(closed.join("room.rbn"), "the old one").unwrap();
    std::fs::set_permissions(&closed, std::fs::Permissions::from_mode(0o555)).unwrap();
    // The superuser may write anywhere; /proc then serves as the unwritable folder.
    let open_to_us = std::fs::write(closed.join("probe"), "").is_ok();
    let output = if open_to_us { Path::new("/proc/room.rbn").to_owned() } else { closed.join("room.rbn") };
    let told = bake("builtin:cornell-box", &output, &[]).output().unwrap();
    fails(&told, &["nothing can be written to the folder"]);
    assert!(!said(&told).contains("preparing"), "{}", said(&told));
    assert_eq!(std::fs::read(closed.join("room.rbn")).unwrap(), b"the old one");
    let nowhere = folder.path().join("none/room.rbn");
    fails(&bake("builtin:cornell-box", &nowhere, &[]).output().unwrap(), &["there is no folder", "none"]);
    std::fs::set_permissions(&closed, std::fs::Permissions::from_mode(0o755)).unwrap();
}

#[test]
fn results_replace_nothing_that_is_read_and_nothing_but_files() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let glb = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/gltf/plain.glb")).unwrap();
    // For any file name, and through any path.
    std::fs::write(at("scene.rbn"), &glb).unwrap();
    std::fs::write(at("scene.glb"), &glb).unwrap();
    std::os::unix::fs::symlink(at("scene.rbn"), at("link.rbn")).unwrap();
    std::os::unix::fs::symlink("/dev/null", at("device.rbn")).unwrap();
    std::fs::create_dir(at("folder.rbn")).unwrap();
    std::fs::write(at("shot.json"), "{}").unwrap();
    let before = names(folder.path());
    let report = at("report.json");
    let report = report.to_str().unwrap();
    let shot = at("shot.json");
    let shot = shot.to_str().unwrap();
    for (scene, output, more, words) in [
        ("scene.rbn", "scene.rbn", vec![], "scene.rbn is the scene and would be overwritten"),
        ("scene.rbn", "link.rbn", vec![], "would be overwritten"),
        ("scene.glb", "scene.glb", vec![], "ends in .rbn"),
        ("scene.glb", "scene.png", vec![], "ends in .rbn"),
        ("scene.glb", "-", vec![], "ends in .rbn"),
        ("scene.glb", "device.rbn", vec![], "not a file"),
        ("scene.glb", "folder.rbn", vec![], "not a file"),
        ("scene.glb", "a.rbn", vec!["--report", "a.rbn"], "ends in .json"),
        ("scene.glb", "a.rbn", vec!["--report", "/no/such/report.json"], "there is no folder /no/such"),
        ("scene.glb", "a.rbn", vec!["--report", shot, "--shot", shot, "--target-error", "1"], "is the shot"),
        ("scene.glb", "a.rbn", vec!["--shot", report], "cannot read"),
        ("folder.rbn", "a.rbn", vec![], "folder.rbn"),
    ] {
        let output = bake(at(scene).to_str().unwrap(), &at(output), &more);
        // A bake for a target error has different arguments.
        let mut command = rebounce(&["bake"]);
        let kept = output.get_args().skip(1).filter(|arg| {
            !more.contains(&"--target-error") || {
                !["--functions", "200", "--levels", "3"].contains(&arg.to_str().unwrap())
            }
        });
        command.args(kept);
        fails(&command.output().unwrap(), &[words]);
        assert_eq!(names(folder.path()), before, "{words}: nothing is left");
        assert_eq!(std::fs::read(at("scene.rbn")).unwrap(), glb);
    }
    // A baked file is no scene.
    let path = at("room.rbn");
    assert!(bake("builtin:cornell-box", &path, &[]).status().unwrap().success());
    fails(&bake(path.to_str().unwrap(), &at("a.rbn"), &[]).output().unwrap(), &["is a baked file"]);
    let picture = at("none/out.exr");
    fails(
        &rebounce(&["reference", "builtin:cornell-box", "-o", picture.to_str().unwrap()]).output().unwrap(),
        &["there is no folder"],
    );
}

#[test]
fn numbers_that_nothing_can_be_baked_with_are_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.rbn");
    for (argument, value) in [
        ("--coarse-radius", "nan"),
        ("--coarse-radius", "0"),
        ("--coarse-radius", "1e-9"),
        ("--coarse-radius", "1e9"),
        ("--epsilon", "nan"),
        ("--significance", "inf"),
        ("--viewpoint", "1,nan,2"),
        ("--bounces", "0"),
        ("--coarse-overlap", "0"),
        ("--fine-overlap", "100"),
        ("--max-bytes", "none"),
    ] {
        let output = bake("builtin:cornell-box", &path, &[argument, value]).output().unwrap();
        assert!(matches!(output.status.code(), Some(1 | 2)), "{argument} {value}: {}", said(&output));
        assert!(said(&output).contains(argument), "{argument} {value}: {}", said(&output));
        assert!(!path.exists());
    }
    for (argument, value) in [("--functions", "0"), ("--functions", "999999999999"), ("--rays", "0")] {
        let scene = "builtin:cornell-box";
        let output =
            rebounce(&["bake", scene, "-o", path.to_str().unwrap(), argument, value]).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{argument} {value}: {}", said(&output));
    }
}

#[test]
fn inputs_that_are_gone_or_cut_are_named_and_the_old_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let glb = std::fs::read(concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/gltf/plain.glb")).unwrap();
    let old = at("old.rbn");
    std::fs::write(&old, "the old one").unwrap();
    std::fs::write(at("cut.glb"), &glb[..glb.len() / 2]).unwrap();
    std::fs::write(at("empty.glb"), "").unwrap();
    std::fs::create_dir(at("folder.glb")).unwrap();
    let beside = |bin: &str| {
        format!(
            r#"{{"asset": {{"version": "2.0"}}, "buffers": [{{"uri": "{bin}", "byteLength": 36}}],
            "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
            "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}],
            "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
            "nodes": [{{"mesh": 0}}], "scenes": [{{"nodes": [0]}}], "scene": 0}}"#
        )
    };
    std::fs::write(at("gone.gltf"), beside("gone.bin")).unwrap();
    // A buffer shorter than declared: the state of a file that shrinks during reading.
    std::fs::write(at("short.gltf"), beside("short.bin")).unwrap();
    std::fs::write(at("short.bin"), [0; 20]).unwrap();
    let before = names(folder.path());
    for (scene, words) in [
        ("none.glb", "none.glb"),
        ("cut.glb", "cut short"),
        ("empty.glb", "empty.glb"),
        ("folder.glb", "folder.glb"),
        ("gone.gltf", "gone.bin"),
        ("short.gltf", "should have 36 bytes, has 20"),
    ] {
        let scene = at(scene);
        let output = bake(scene.to_str().unwrap(), &old, &[]).output().unwrap();
        fails(&output, &[words, scene.file_name().unwrap().to_str().unwrap()]);
        assert_eq!(std::fs::read(&old).unwrap(), b"the old one");
        assert_eq!(names(folder.path()), before, "{words}: nothing is left");
    }
    // The same tests for baked files, and for text with terminal control sequences.
    let bad = at("b\x1b[31mad.rbn");
    for contents in [&b"REBOUNCE"[..], b"", b"REBOUNCE\x09\0\0\0 and more, of 32 bytes and over"] {
        std::fs::write(&bad, contents).unwrap();
        let output = rebounce(&["info", bad.to_str().unwrap()]).output().unwrap();
        fails(&output, &["ad.rbn"]);
        assert!(!output.stderr.contains(&0x1b), "{}", said(&output));
    }
}

#[test]
fn the_page_is_served_until_ctrl_c() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.rbn");
    assert!(bake("builtin:cornell-box", &path, &[]).status().unwrap().success());
    let mut view = rebounce(&["view", "--no-open", "--port", "0", path.to_str().unwrap()]).spawn().unwrap();
    let mut line = String::new();
    BufReader::new(view.stdout.take().unwrap()).read_line(&mut line).unwrap();
    if line.is_empty() {
        let output = view.wait_with_output().unwrap();
        return fails(&output, &["built without the viewer", "cargo xtask web"]);
    }
    let host = line.split_once("http://").and_then(|(_, rest)| rest.split_once('/')).unwrap().0.to_owned();
    assert!(host.starts_with("127.0.0.1:"), "{line}");
    let get = |target: &str| {
        let mut stream = TcpStream::connect(&host).unwrap();
        write!(stream, "GET {target} HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).unwrap();
        answer
    };
    assert!(get("/scene.rbn").ends_with(&std::fs::read(&path).unwrap()));
    assert!(get("/").starts_with(b"HTTP/1.1 200 OK"));
    assert!(get("/../room.rbn").starts_with(b"HTTP/1.1 404"));
    assert!(Command::new("kill").args(["-s", "INT", &view.id().to_string()]).status().unwrap().success());
    assert_eq!(view.wait().unwrap().code(), Some(130));
    assert!(TcpStream::connect(&host).is_err(), "nobody listens any more");
}
