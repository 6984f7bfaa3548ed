//! The command, killed, stopped and short of disk space: the earlier file is intact, and `--resume` continues the
//! bake.
#![cfg(unix)]

use program::{goes_on_to, held, names, said};
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use crate::common::program;

const SCENE: &str = "builtin:two-rooms-door";

fn command(output: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rebounce"));
    command.args([
        "bake",
        SCENE,
        "--preset",
        "draft",
        "--functions",
        "3000",
        "--rays",
        "2048",
        "--threads",
        "2",
    ]);
    command.arg("-o").arg(output).args(more);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// Bytes and duration of an uninterrupted bake.
fn uninterrupted(folder: &Path) -> (Vec<u8>, Duration) {
    let (path, began) = (folder.join("whole.rbn"), Instant::now());
    let output = command(&path, &[]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert_eq!(names(folder), ["whole.rbn"], "nothing is left beside it");
    (std::fs::read(path).unwrap(), began.elapsed())
}

#[test]
fn killed_at_any_time_it_goes_on_to_the_same_file() {
    let folder = tempfile::tempdir().unwrap();
    let (expected, took) = uninterrupted(folder.path());
    let path = folder.path().join("room.rbn");
    std::fs::write(&path, "the old one").unwrap();
    for share in [0.03, 0.3, 0.5, 0.7, 0.9] {
        let mut child = command(&path, &["--resume"]).spawn().unwrap();
        std::thread::sleep(took.mul_f64(share));
        // The process may have ended already; every run resumes.
        let _ = child.kill();
        child.wait().unwrap();
        let now = std::fs::read(&path).unwrap();
        assert!(now == b"the old one" || now == expected, "killed after {share} of the time");
    }
    let output = command(&path, &["--resume"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(std::fs::read(&path).unwrap() == expected);
    assert!(!names(folder.path()).contains(&"room.rbn.partial".to_owned()));
}

#[test]
fn signals_stop_it_and_it_goes_on() {
    let folder = tempfile::tempdir().unwrap();
    let (expected, _) = uninterrupted(folder.path());
    let path = folder.path().join("room.rbn");
    // While points are placed, then while links are traced.
    for (name, code, more) in [("INT", 130, 1_000), ("TERM", 143, 400_000)] {
        let child = held(|| command(&path, &["--resume"]).spawn().unwrap(), &path, more);
        let output = goes_on_to(child, name);
        assert_eq!(output.status.code(), Some(code), "{}", said(&output));
        assert!(said(&output).contains("room.rbn.partial has what was done"), "{}", said(&output));
        assert!(!path.exists());
    }
    let output = command(&path, &["--resume"]).output().unwrap();
    assert!(said(&output).contains("going on from"), "{}", said(&output));
    assert!(std::fs::read(&path).unwrap() == expected);
}

#[test]
fn without_room_the_old_file_stays() {
    let folder = tempfile::tempdir().unwrap();
    let (expected, _) = uninterrupted(folder.path());
    let path = folder.path().join("room.rbn");
    std::fs::write(&path, "the old one").unwrap();
    // The file size is limited to about 200 kB; the limit's signal (SIGXFSZ) is ignored: writing fails as on a full
    // disk.
    let bake = command(&path, &[]);
    let mut limited = Command::new("sh");
    limited.args(["-c", "trap '' XFSZ; ulimit -f 300; exec \"$@\"", "sh"]);
    limited.arg(bake.get_program()).args(bake.get_args());
    let output = limited.output().unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", said(&output));
    assert!(
        said(&output).contains("room.rbn.partial") && said(&output).contains("--resume"),
        "{}",
        said(&output)
    );
    assert_eq!(std::fs::read(&path).unwrap(), b"the old one");
    let output = command(&path, &["--resume"]).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    assert!(std::fs::read(&path).unwrap() == expected);
}

#[test]
fn other_settings_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.rbn");
    goes_on_to(held(|| command(&path, &[]).spawn().unwrap(), &path, 1_000), "KILL");
    let output = command(&path, &["--resume", "--seed", "2"]).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(said(&output).contains("seed 1, not 2"), "{}", said(&output));
    for wrong in [&["--what"][..], &["--levels", "0"], &["--levels", "33"]] {
        assert_eq!(command(&path, wrong).output().unwrap().status.code(), Some(2), "{wrong:?}");
    }
}

#[test]
fn progress_is_json_on_demand() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.rbn");
    let output = command(&path, &["--json-progress"]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let lines: Vec<serde_json::Value> =
        text.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let stages: Vec<&str> = lines.iter().map(|line| line["stage"].as_str().unwrap()).collect();
    for stage in ["building BVH", "placing points", "gathering links", "multibounce"] {
        assert!(stages.contains(&stage), "{stage}");
    }
    assert_eq!(stages.last(), Some(&"done"));
    let number = |line: &serde_json::Value, name: &str| line[name].as_f64().unwrap();
    for pair in lines.windows(2) {
        assert!(number(&pair[0], "seconds") <= number(&pair[1], "seconds"));
        assert!((0.0..=1.0).contains(&number(&pair[0], "fraction")));
    }
    assert!(lines.iter().any(|line| line["rays_per_second"].as_f64().is_some_and(|rate| rate > 0.0)));
}

/// The last line of standard output.
fn last_line(output: &Output) -> serde_json::Value {
    let text = String::from_utf8(output.stdout.clone()).unwrap();
    serde_json::from_str(text.lines().last().unwrap()).unwrap()
}

#[test]
fn json_says_how_a_bake_ended() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("room.rbn");
    let child = held(|| command(&path, &["--json-progress"]).spawn().unwrap(), &path, 1_000);
    let output = goes_on_to(child, "INT");
    assert_eq!(output.status.code(), Some(130), "{}", said(&output));
    let (partial, last) = (folder.path().join("room.rbn.partial"), last_line(&output));
    assert_eq!((&last["stage"], &last["checkpoint"]), (&"stopped".into(), &partial.to_str().unwrap().into()));
    // Before the start of the bake, and at its start.
    let missing = folder.path().join("missing.glb");
    let mut bake = Command::new(env!("CARGO_BIN_EXE_rebounce"));
    bake.arg("bake").arg(&missing).arg("--json-progress");
    let refused = command(&path, &["--resume", "--seed", "2", "--json-progress"]);
    for (mut command, word) in [(bake, "missing.glb"), (refused, "seed 1, not 2")] {
        let output = command.stdout(Stdio::piped()).stderr(Stdio::piped()).output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        let last = last_line(&output);
        assert_eq!(last["stage"], "failed");
        let error = last["error"].as_str().unwrap();
        assert!(error.contains(word) && said(&output).contains(error), "{error}");
    }
}
