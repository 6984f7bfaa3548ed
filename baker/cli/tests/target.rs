//! `rebounce bake --target-error` and `rebounce compare`: the stated error holds, or the exit code is an error.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use glam::Vec3;
use rebounce::io::picture::Picture;
use rebounce_shared::random::Stream;
use std::path::Path;
use std::process::{Command, Output};

/// A bake with few rays: the error exceeds the noise of the path tracer.
fn bake(folder: &Path, more: &[&str]) -> Output {
    let args = ["bake", "builtin:cornell-box", "-o", "box.rbn", "--report", "box.json", "--rays", "8"];
    Command::new(env!("CARGO_BIN_EXE_rebounce")).current_dir(folder).args(args).args(more).output().unwrap()
}

fn report(folder: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(folder.join("box.json")).unwrap()).unwrap()
}

#[test]
fn an_error_that_is_met_is_measured_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let output = bake(folder.path(), &["--target-error", "0.3", "--json-progress"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    let report = report(folder.path());
    let error = report["measured_error"].as_f64().unwrap();
    assert!(error > 0.005 && error <= 0.3, "{error}");
    assert_eq!(report["preset"], "draft");
    assert!(said.contains(&format!("error {error:.3}")), "{said}");
    let ends = ["at_least", "at_most"].map(|end| report[&format!("measured_error_{end}")].as_f64().unwrap());
    assert!(0.8 * error < ends[0] && ends[0] < error && error < ends[1] && ends[1] < 0.3, "{ends:?}");
    let printed = String::from_utf8(output.stdout).unwrap();
    let last: serde_json::Value = serde_json::from_str(printed.lines().last().unwrap()).unwrap();
    for key in ["measured_error", "measured_error_at_least", "measured_error_at_most"] {
        assert_eq!(last[key], report[key], "{key}: {last}");
    }
    let first: serde_json::Value = serde_json::from_str(printed.lines().next().unwrap()).unwrap();
    assert!(last["stage"] == "done" && first.get("measured_error").is_none(), "{first}, {last}");
    assert!(folder.path().join("box.rbn").is_file() && !folder.path().join("box.rbn.partial").exists());
}

#[test]
fn an_error_that_cannot_be_met_has_an_exit_code_and_a_culprit() {
    let folder = tempfile::tempdir().unwrap();
    let output = bake(folder.path(), &["--target-error", "0.001", "--max-bytes", "500K"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(3), "{said}");
    assert!(said.contains("over --target-error 0.001") && said.contains("is on material"), "{said}");
    assert!(report(folder.path())["measured_error"].as_f64().unwrap() > 0.001);
    assert!(folder.path().join("box.rbn").metadata().unwrap().len() <= 500_000);
}

#[test]
fn what_is_no_error_is_a_wrong_argument() {
    let folder = tempfile::tempdir().unwrap();
    for error in ["0", "-0.1", "NaN", "inf", "small"] {
        let output = bake(folder.path(), &[&format!("--target-error={error}")]);
        assert_eq!(output.status.code(), Some(2), "{error}");
    }
    let shot = bake(folder.path(), &["--target-error", "0.1", "--shot", "no/such.shot.json"]);
    assert_eq!(shot.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&shot.stderr).contains("no/such.shot.json"));
    assert!(!folder.path().join("box.rbn").exists());
}

/// Writes a uniform grey picture with noise of relative strength `noise`.
fn grey(folder: &Path, name: &str, brightness: f32, noise: f32, seed: u64) {
    let of = |i| brightness * (1.0 + noise * (2.0 * Stream::new(seed, i).unit() - 1.0));
    let picture =
        Picture { width: 64, height: 40, pixels: (0..64 * 40).map(|i| Vec3::splat(of(i))).collect() };
    picture.write(&folder.join(name), f32::INFINITY).unwrap();
}

/// Exit code and outputs of a comparison.
fn compare(folder: &Path, files: &[&str], more: &[&str]) -> (Option<i32>, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_rebounce"));
    let output = command.current_dir(folder).arg("compare").args(files).args(more).output().unwrap();
    let [printed, said] = [output.stdout, output.stderr].map(|bytes| String::from_utf8(bytes).unwrap());
    (output.status.code(), printed, said)
}

#[test]
fn an_error_that_noise_hides_is_too_noisy_to_tell_and_never_none() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    grey(folder, "near.exr", 1.002, 0.0, 0);
    grey(folder, "far.exr", 1.3, 0.0, 0);
    grey(folder, "a.exr", 1.0, 0.9, 1);
    grey(folder, "b.exr", 1.0, 0.9, 2);
    let near = ["near.exr", "a.exr", "b.exr"];
    let (code, printed, _) = compare(folder, &near, &[]);
    assert!(code == Some(0) && printed.starts_with("error too noisy to tell, at most 0."), "{printed}");
    let (_, printed, _) = compare(folder, &near, &["--json"]);
    let json: serde_json::Value = serde_json::from_str(&printed).unwrap();
    let most = json["error_at_most"].as_f64().unwrap();
    assert!(
        json["error"].is_null() && json["error_at_least"] == 0.0 && (0.01..0.3).contains(&most),
        "{json}"
    );
    let (code, _, said) = compare(folder, &near, &["--max-error", "0.003"]);
    assert!(
        code == Some(4) && said.contains("too noisy to tell whether") && said.contains("--spp"),
        "{said}"
    );
    // The upper bound of the error is known in any case.
    assert_eq!(compare(folder, &near, &["--max-error", "0.3"]).0, Some(0));
    let far = ["far.exr", "a.exr", "b.exr"];
    let (code, printed, said) = compare(folder, &far, &["--max-error", "0.1"]);
    assert!(code == Some(1) && said.contains("is above 0.1"), "{said}");
    assert!(printed.starts_with("error 0.") && printed.contains(" to 0."), "{printed}");
    assert_eq!(compare(folder, &far, &["--max-error", "0.6"]).0, Some(0));
    // With a single reference, the noise is unknown.
    let (code, printed, said) = compare(folder, &near[..2], &["--max-error", "0.1"]);
    assert!(code == Some(1) && printed.contains("the reference's noise in it"), "{printed}");
    assert!(said.contains("a second reference takes out"), "{said}");
}
