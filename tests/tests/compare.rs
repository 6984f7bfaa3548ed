//! The program `compare`, as the browser's tests call it.

use std::process::Command;

#[test]
fn compare_prints_json_or_fails() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, value: f32| {
        let file = dir.path().join(name);
        std::fs::write(&file, value.to_le_bytes().repeat(2 * 4)).unwrap();
        file
    };
    let (one, two) = (write("one-2x1.f32", 1.0), write("two-2x1.f32", 2.0));
    let run = |files: &[&std::path::PathBuf]| {
        Command::new(env!("CARGO_BIN_EXE_compare")).args(files).output().unwrap()
    };
    let output = run(&[&two, &one]);
    assert!(output.status.success());
    let text = String::from_utf8(output.stdout).unwrap();
    assert_eq!(
        text.trim(),
        r#"{"error":1.0,"error_at_least":null,"error_at_most":null,"bias":1.0,"p95":0.0}"#
    );
    assert!(!run(&[&two]).status.success());
}
