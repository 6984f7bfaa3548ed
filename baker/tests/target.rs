//! `rebounce bake --target-error`: the file that is written is as good as it says, or the exit code tells.

use std::path::Path;
use std::process::{Command, Output};

fn bake(folder: &Path, more: &[&str]) -> Output {
    let args = ["bake", "builtin:cornell-box", "-o", "box.rbn", "--report", "box.json", "--rays", "128"];
    Command::new(env!("CARGO_BIN_EXE_rebounce")).current_dir(folder).args(args).args(more).output().unwrap()
}

fn report(folder: &Path) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(folder.join("box.json")).unwrap()).unwrap()
}

#[test]
fn an_error_that_is_met_is_measured_and_written() {
    let folder = tempfile::tempdir().unwrap();
    let output = bake(folder.path(), &["--target-error", "0.2"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(0), "{said}");
    let report = report(folder.path());
    let error = report["measured_error"].as_f64().unwrap();
    assert!(error > 0.005 && error <= 0.2, "{error}");
    assert_eq!(report["preset"], "draft");
    assert!(said.contains(&format!("error {error:.3}")), "{said}");
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
