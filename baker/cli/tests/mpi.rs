//! The command under `mpirun`: the same file as from a single process, to the byte; after the loss of a process,
//! finished work is kept. `cargo xtask test mpi` runs these tests alone.
#![cfg(unix)]

use program::{partial, said, signal, wait_for};
use std::collections::HashSet;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

#[path = "common/program.rs"]
mod program;

/// Each test starts processes for all processors.
fn one_at_a_time() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

const BINARY: &str = env!("CARGO_BIN_EXE_rebounce");

fn bake(command: &mut Command, output: &Path, threads: usize, more: &[&str]) -> Command {
    let mut command = std::mem::replace(command, Command::new("true"));
    command.args(["bake", "builtin:two-rooms-door", "--preset", "draft"]);
    command.args(["--threads", &threads.to_string(), "-o"]).arg(output).args(more);
    // Enough functions for signals to arrive before the end, and few enough rays per function for frequent checks.
    for (name, value) in [("--functions", "16000"), ("--rays", "512")] {
        if !more.contains(&name) {
            command.args([name, value]);
        }
    }
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// The command on `processes` processes, for any number of processors.
fn together(processes: usize, threads: usize, output: &Path, more: &[&str]) -> Command {
    let mut command = Command::new("mpirun");
    command.env("OMPI_ALLOW_RUN_AS_ROOT", "1").env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1");
    command.args(["--oversubscribe", "--bind-to", "none", "-n", &processes.to_string(), BINARY]);
    bake(&mut command, output, threads, more)
}

fn alone(output: &Path, more: &[&str]) -> Vec<u8> {
    let done = bake(&mut Command::new(BINARY), output, 2, more).output().unwrap();
    assert!(done.status.success(), "{}", said(&done));
    std::fs::read(output).unwrap()
}

/// Processes started by mpirun, by rank.
fn members(mpirun: &Child) -> Vec<(usize, u32)> {
    let listed =
        Command::new("ps").args(["-o", "pid=", "--ppid", &mpirun.id().to_string()]).output().unwrap();
    let pids = String::from_utf8(listed.stdout).unwrap();
    let rank = |pid: u32| {
        let environment = std::fs::read(format!("/proc/{pid}/environ")).ok()?;
        let value = environment.split(|byte| *byte == 0);
        let mut found = value.filter_map(|entry| entry.strip_prefix(b"OMPI_COMM_WORLD_RANK="));
        Some((String::from_utf8_lossy(found.next()?).parse().ok()?, pid))
    };
    pids.split_whitespace().filter_map(|pid| rank(pid.parse().ok()?)).collect()
}

/// The launcher may end slightly before its processes. A process still present after minutes hangs.
fn all_end(members: &[(usize, u32)]) -> bool {
    let began = Instant::now();
    let is_there = |member: &(usize, u32)| Path::new(&format!("/proc/{}", member.1)).exists();
    while members.iter().any(is_there) && began.elapsed() < Duration::from_secs(300) {
        std::thread::sleep(Duration::from_millis(20));
    }
    !members.iter().any(is_there)
}

#[test]
fn any_number_of_processes_and_threads_makes_the_same_file() {
    let _alone = one_at_a_time();
    let folder = tempfile::tempdir().unwrap();
    let few = ["--functions", "4000"];
    let expected = alone(&folder.path().join("alone.rbn"), &few);
    for (processes, threads) in [(1, 2), (2, 2), (4, 1)] {
        let path = folder.path().join("team.rbn");
        let done = together(processes, threads, &path, &few).output().unwrap();
        assert!(done.status.success(), "{}", said(&done));
        assert!(std::fs::read(&path).unwrap() == expected, "{processes} processes of {threads} threads");
        assert!(!partial(&path).exists());
        let summary = String::from_utf8(done.stdout).unwrap();
        assert_eq!(summary.matches("wrote").count(), 1, "only one process speaks: {summary}");
        assert_eq!(summary.contains(&format!("processes     {processes};")), processes > 1, "{summary}");
    }
}

#[test]
fn a_lost_process_ends_the_others_and_any_number_goes_on() {
    let _alone = one_at_a_time();
    let folder = tempfile::tempdir().unwrap();
    let expected = alone(&folder.path().join("alone.rbn"), &[]);
    // The last, and the first itself; while points are placed, and while links are traced.
    for (lost, bytes, number) in [(3, 1_000, 4), (0, 400_000, 2)] {
        let path = folder.path().join(format!("lost-{lost}.rbn"));
        // Seconds between the signals that end and that kill the remaining processes: on a busy machine, one second
        // is too short for an error message.
        let patient = ("OMPI_MCA_odls_base_sigkill_timeout", "5");
        let mut running = together(4, 1, &path, &[]).env(patient.0, patient.1).spawn().unwrap();
        wait_for(&mut running, &path, bytes);
        let members = members(&running);
        assert_eq!(members.iter().map(|member| member.0).collect::<HashSet<_>>(), (0..4).collect());
        signal(members.iter().find(|member| member.0 == lost).unwrap().1, "KILL");
        let ended = running.wait_with_output().unwrap();
        assert!(!ended.status.success() && !path.exists());
        let words = said(&ended);
        assert!(words.contains("exited on signal 9"), "the launcher says who was lost: {words}");
        if lost != 0 {
            assert!(words.contains("another process of this bake was lost"), "{words}");
            assert!(words.contains("partial has what was done, and --resume goes on"), "{words}");
        }
        assert!(all_end(&members), "a process goes on for ever");
        let kept = partial(&path).metadata().unwrap().len();
        assert!(kept >= bytes);
        let done = together(number, 1, &path, &["--resume"]).output().unwrap();
        assert!(done.status.success() && said(&done).contains("going on from"), "{}", said(&done));
        assert!(std::fs::read(&path).unwrap() == expected, "{number} go on");
    }
}

#[test]
fn ctrl_c_ends_all_and_says_how_to_go_on() {
    let _alone = one_at_a_time();
    let folder = tempfile::tempdir().unwrap();
    // Enough rays for the launcher's signals, up to a second late, to arrive before the end.
    let rays = ["--rays", "3000", "--resume"];
    let expected = alone(&folder.path().join("alone.rbn"), &rays[..2]);
    let path = folder.path().join("room.rbn");
    for more in [1_000, 400_000] {
        let kept = partial(&path).metadata().map_or(0, |m| m.len());
        let mut running = together(2, 1, &path, &rays).spawn().unwrap();
        wait_for(&mut running, &path, kept + more);
        let members = members(&running);
        signal(running.id(), "INT");
        let ended = running.wait_with_output().unwrap();
        assert!(!ended.status.success() && !path.exists());
        assert!(said(&ended).contains("--resume goes on"), "{}", said(&ended));
        assert!(members.len() == 2 && all_end(&members), "a process goes on for ever");
    }
    let done = together(2, 2, &path, &rays).output().unwrap();
    assert!(done.status.success(), "{}", said(&done));
    assert!(std::fs::read(&path).unwrap() == expected);
}

#[test]
fn an_error_is_said_once_and_ends_all() {
    let _alone = one_at_a_time();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("none/room.rbn");
    let ended = together(3, 1, &path, &[]).output().unwrap();
    assert!(!ended.status.success());
    assert_eq!(said(&ended).matches("there is no folder").count(), 1, "{}", said(&ended));
}
