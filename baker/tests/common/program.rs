//! The command as a process of its own: what it says and leaves, and how it is ended.
#![allow(dead_code, reason = "not every test needs all of it")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output};
use std::time::Duration;

/// What a process wrote to its standard error.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What lies in a folder, in order.
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

/// Waits until the checkpoint beside this output has this many bytes.
pub fn wait_for(child: &mut Child, output: &Path, bytes: u64) {
    while partial(output).metadata().map_or(0, |m| m.len()) < bytes {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it kept {bytes} bytes");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Sends a process a signal.
pub fn signal(pid: u32, name: &str) {
    assert!(Command::new("kill").args(["-s", name, &pid.to_string()]).status().unwrap().success());
}
