//! Pages of docs/reports: figures, headed with the command, the commit, the processor and the date.

use crate::process;
use anyhow::{Context, Result, bail};
use std::process::{Command, Stdio};
use std::time::{SystemTime, UNIX_EPOCH};

/// Folder of the reports.
pub fn folder() -> std::path::PathBuf {
    process::root().join("docs/reports")
}

/// Writes docs/reports/NAME.md: the title, the line of the measurement, and the figures. `command` is the one that
/// makes the report.
///
/// # Errors
/// If the file cannot be written.
pub fn write(name: &str, title: &str, command: &str, figures: &str) -> Result<()> {
    let path = folder().join(format!("{name}.md"));
    std::fs::create_dir_all(folder()).with_context(|| folder().display().to_string())?;
    let page = format!("# {title}\n\n{}\n\n{}\n", head(command), figures.trim());
    std::fs::write(&path, page).with_context(|| path.display().to_string())?;
    println!("wrote {}", path.display());
    Ok(())
}

/// Runs an example of the tests with these arguments, and writes what it prints as [`write()`] does. `line` is the command that
/// makes the report.
///
/// # Errors
/// If the example or the writing fails.
pub fn of_example(name: &str, title: &str, args: &[String], line: &str) -> Result<()> {
    let figures = printed_by("rebounce-tests", name, args)?;
    println!("{figures}");
    write(name, title, line, &figures)
}

/// Runs an example of a package with these arguments; returns what it prints.
///
/// # Errors
/// If the example fails.
pub fn printed_by(package: &str, example: &str, args: &[String]) -> Result<String> {
    let mut command = process::cargo();
    command.args(["run", "--release", "--locked", "--package", package, "--example", example, "--"]);
    let output = command.args(args).stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.with_context(|| format!("the example {example} could not be run"))?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    if !output.status.success() {
        // What there was before.
        println!("{text}");
        bail!("the example {example} did not finish ({})", output.status);
    }
    Ok(text)
}

/// The line of a measurement.
fn head(command: &str) -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |time| time.as_secs());
    let [year, month, day] = date(seconds / 86_400);
    let made = format!("Made by `{command}`");
    let at = format!("at commit {} on {year}-{month:02}-{day:02},", commit());
    // Lines of 100 columns.
    let gap = if made.len() + at.len() < 100 { ' ' } else { '\n' };
    format!("{made}{gap}{at}\n{}.", processor())
}

/// Commit of the working tree, and whether it has changes.
fn commit() -> String {
    let git = |args: &[&str]| process::quiet(Command::new("git").args(args).current_dir(process::root()));
    let Some(commit) = git(&["rev-parse", "--short", "HEAD"]) else { return "unknown".to_owned() };
    let has_changes =
        git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|list| !list.trim().is_empty());
    format!("{}{}", commit.trim(), if has_changes { " with changes" } else { "" })
}

/// Name of the processor, and the number of its threads.
fn processor() -> String {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let cpus = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = cpus.lines().find_map(|line| line.strip_prefix("model name")?.split_once(": "));
    let name = name.map_or("an unknown processor", |(_, name)| name.trim());
    format!("{name}, {threads} threads")
}

/// Year, month and day of a number of days since 1970-01-01 (Hinnant, "chrono-compatible low-level date algorithms").
fn date(days: u64) -> [u64; 3] {
    let days = days + 719_468;
    let (era, of_era) = (days / 146_097, days % 146_097);
    let year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    [era * 400 + year + u64::from(month <= 2), month, day]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_become_dates() {
        assert_eq!(date(0), [1970, 1, 1]);
        assert_eq!(date(11_016), [2000, 2, 29]);
        assert_eq!(date(20_783), [2026, 11, 26]);
    }

    #[test]
    fn a_report_says_where_it_is_from() {
        let head = head("cargo xtask bench-bake");
        assert!(head.contains("`cargo xtask bench-bake` at commit ") && head.ends_with("threads."), "{head}");
    }
}
