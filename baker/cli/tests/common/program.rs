//! The command as a child process: output, files and signals.
#![allow(dead_code, reason = "not every test needs all of it")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::time::Duration;

/// Runs the command in a folder.
pub fn rebounce(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rebounce")).current_dir(folder).args(args).output().unwrap()
}

/// Runs the command in a folder, asserts success, and returns what it printed.
pub fn done(folder: &Path, args: &[&str]) -> String {
    let output = rebounce(folder, args);
    assert_eq!(output.status.code(), Some(0), "{args:?}: {}", said(&output));
    String::from_utf8(output.stdout).unwrap()
}

/// Standard error of a process.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// Sorted names of a folder's entries.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The checkpoint beside an output.
pub fn partial(output: &Path) -> PathBuf {
    PathBuf::from(format!("{}.partial", output.display()))
}

/// Waits until the checkpoint beside `output` has at least `bytes` bytes.
pub fn wait_for(child: &mut Child, output: &Path, bytes: u64) {
    while partial(output).metadata().map_or(0, |m| m.len()) < bytes {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it kept {bytes} bytes");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Starts a bake and suspends the process (SIGSTOP) once the checkpoint beside `output` has grown by `more` bytes.
/// Starts again if the bake ends too early, as on a busy machine.
pub fn held(start: impl Fn() -> Child, output: &Path, more: u64) -> Child {
    let size = || partial(output).metadata().map_or(0, |m| m.len());
    loop {
        let bytes = size() + more;
        let mut child = start();
        while size() < bytes && !is_over(&mut child) {
            std::thread::sleep(Duration::from_millis(5));
        }
        if !is_over(&mut child) {
            signal(child.id(), "STOP");
            while !is_over(&mut child) {
                let state = Command::new("ps").args(["-o", "state=", "-p", &child.id().to_string()]).output();
                if state.unwrap().stdout.starts_with(b"T") {
                    return child;
                }
            }
        }
        let _ = std::fs::remove_file(output);
    }
}

fn is_over(child: &mut Child) -> bool {
    let status = child.try_wait().unwrap();
    assert!(status.is_none_or(|status| status.success()), "it failed before it kept enough");
    status.is_some()
}

/// Sends a suspended bake the signal `name`, continues the process (SIGCONT) and returns its output.
pub fn goes_on_to(child: Child, name: &str) -> Output {
    signal(child.id(), name);
    signal(child.id(), "CONT");
    child.wait_with_output().unwrap()
}

/// Sends a signal to a process.
pub fn signal(pid: u32, name: &str) {
    assert!(Command::new("kill").args(["-s", name, &pid.to_string()]).status().unwrap().success());
}
