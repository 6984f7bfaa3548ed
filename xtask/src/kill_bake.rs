//! `cargo xtask kill-bake`: kills bakes at various times, resumes them, and compares the results.

use crate::process;
use anyhow::{Context, Result, bail};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

struct Options {
    times: u32,
    scene: String,
    /// Whether every kill is followed by a bake to the end; otherwise a bake is killed many times.
    each: bool,
    /// Additional arguments of `rebounce bake`.
    more: Vec<String>,
}

fn parse(args: &[String]) -> Result<Options> {
    let scene = "builtin:cornell-box".to_owned();
    let mut options = Options { times: 100, scene, each: false, more: Vec::new() };
    let mut args = args.iter();
    while let Some(name) = args.next() {
        let mut value = || args.next().with_context(|| format!("{name} needs a value"));
        match name.as_str() {
            "--times" => options.times = value()?.parse().context("--times needs a number")?,
            "--scene" => options.scene = value()?.clone(),
            "--each" => options.each = true,
            "--" => options.more = args.by_ref().cloned().collect(),
            other => bail!(
                "there is no option {other}; there are --times, --scene, --each and -- with options of the bake"
            ),
        }
    }
    Ok(options)
}

/// Kills bakes and compares the results.
///
/// # Errors
/// If a bake fails, or its file differs from the file of an undisturbed bake.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    process::run(process::cargo().args(["build", "--locked", "--release", "--package", "rebounce-cli"]))?;
    let work = process::target().join("kill-bake");
    std::fs::create_dir_all(&work).with_context(|| work.display().to_string())?;
    let whole = work.join("whole.rbn");
    let began = Instant::now();
    let status = bake(&options, &whole, &[]).status()?;
    if !status.success() {
        bail!("the bake that nobody kills failed ({status})");
    }
    let mut took = began.elapsed();
    println!("a bake that nobody kills takes {:.1} s", took.as_secs_f64());
    let expected = std::fs::read(&whole)?;
    let output = work.join("killed.rbn");
    remove(&output)?;
    let (mut kills, mut completions, mut bytes_kept) = (0u32, 0u32, 0);
    // The last bake is not killed.
    let (mut is_over, mut was_killed) = (false, false);
    while !is_over {
        // Kill times cover the duration of a bake, with more kills early in the bake.
        let share = (f64::from(kills) * 0.618_034).fract();
        is_over = kills >= options.times;
        let began = Instant::now();
        let to_the_end = is_over || options.each && was_killed;
        let limit = if to_the_end { Duration::MAX } else { took.mul_f64(0.02 + 0.9 * share * share) };
        let ended = killed_after(&mut bake(&options, &output, &["--resume"]), limit)?;
        let is_fresh = !std::mem::replace(&mut was_killed, ended.is_none());
        match ended {
            None => {
                kills += 1;
                bytes_kept = bytes_kept.max(partial(&output).metadata().map_or(0, |metadata| metadata.len()));
                // A kill between the last two steps leaves a complete file.
                if output.exists() && std::fs::read(&output)? != expected {
                    bail!("kill {kills} left a wrong {}", output.display());
                }
            }
            Some(status) if status.success() => {
                completions += 1;
                if std::fs::read(&output)? != expected {
                    bail!("after {kills} kills: {} differs from {}", output.display(), whole.display());
                }
                if is_fresh {
                    // This bake was faster than the first: later kill times must still fall within the duration.
                    took = took.min(began.elapsed());
                }
                println!(
                    "{kills} kills, {completions} bakes done in spite of them, each the same {} bytes",
                    expected.len()
                );
                remove(&output)?;
            }
            Some(status) => bail!("after {kills} kills the bake failed ({status})"),
        }
    }
    println!(
        "{kills} kills, {completions} bakes, all the same bytes; a checkpoint held {bytes_kept} bytes at most"
    );
    Ok(())
}

fn bake(options: &Options, output: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(process::target().join("release/rebounce"));
    command.args(["bake", &options.scene, "--preset", "draft"]).args(&options.more).args(more);
    command.arg("-o").arg(output).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command
}

/// Exit status of the command; `None` if killed after `limit`.
fn killed_after(command: &mut Command, limit: Duration) -> Result<Option<ExitStatus>> {
    let mut child = command.spawn().context("starting rebounce")?;
    let began = Instant::now();
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if began.elapsed() >= limit {
            child.kill()?;
            let status = child.wait()?;
            // The process may have ended by itself at the last moment.
            return Ok(status.code().map(|_| status));
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn partial(output: &Path) -> PathBuf {
    PathBuf::from(format!("{}.partial", output.display()))
}

fn remove(output: &Path) -> Result<()> {
    for file in [output.to_owned(), partial(output)] {
        if file.exists() {
            std::fs::remove_file(&file).with_context(|| file.display().to_string())?;
        }
    }
    Ok(())
}
