//! `cargo xtask audit`: checks dependencies for known vulnerabilities, licences, duplicate versions and sources.

use crate::process;
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::process::Command;

/// Result of a check.
#[derive(Debug, PartialEq)]
enum Outcome {
    Passed,
    /// The check printed findings.
    Failed,
    /// The check could not run: reason.
    Unchecked(String),
}

/// Runs the checks. With `--offline`, checks that need the network may be skipped.
///
/// # Errors
/// If a check finds a problem, or, without `--offline`, cannot run: no check passes silently.
pub fn run(args: &[String]) -> Result<()> {
    let is_offline = match args {
        [] => false,
        [only] if only == "--offline" => true,
        _ => bail!("audit has one option, --offline"),
    };
    if process::quiet(Command::new("cargo").args(["deny", "--version"])).is_none() {
        println!("installing cargo-deny, through cargo: checks licences, versions, sources and advisories");
        process::run(process::cargo().args(["install", "--locked", "cargo-deny"]))?;
    }
    let checks =
        ["licences, versions and sources of crates", "advisories of crates", "advisories of npm packages"];
    let outcomes = [
        deny(&["licenses", "bans", "sources"])?,
        if is_offline { skipped() } else { deny(&["advisories"])? },
        if is_offline { skipped() } else { npm()? },
    ];
    let mut is_clean = true;
    for (what, outcome) in checks.iter().zip(outcomes) {
        match outcome {
            Outcome::Passed => println!("{what}: nothing found"),
            Outcome::Failed => {
                println!("{what}: FAILED, see above");
                is_clean = false;
            }
            Outcome::Unchecked(why) => {
                println!("{what}: NOT CHECKED: {why}");
                is_clean &= is_offline;
            }
        }
    }
    if is_clean { Ok(()) } else { bail!("not all of it passed") }
}

fn skipped() -> Outcome {
    Outcome::Unchecked("it needs the network, and --offline was given".to_owned())
}

/// Runs cargo-deny's checks over the locked versions.
fn deny(checks: &[&str]) -> Result<Outcome> {
    let mut command = process::cargo();
    command.args(["deny", "--locked", "check", "--hide-inclusion-graph"]).args(checks);
    let output = command.output().context("cargo deny")?;
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    print!("{}", String::from_utf8_lossy(&output.stdout));
    Ok(of_deny(output.status.success(), &said))
}

fn of_deny(is_success: bool, said: &str) -> Outcome {
    let unreachable = said.lines().find(|line| line.contains("failed to fetch advisory database"));
    match (is_success, unreachable) {
        (true, _) => Outcome::Passed,
        (false, Some(line)) => Outcome::Unchecked(line.trim().to_owned()),
        (false, None) => {
            eprint!("{said}");
            Outcome::Failed
        }
    }
}

/// Runs `npm audit` over the locked versions of the web package, and of the packages of the web benchmark.
fn npm() -> Result<Outcome> {
    for folder in ["web", "web/bench"] {
        let mut command = Command::new("npm");
        command.args(["audit", "--json", "--package-lock-only"]).current_dir(process::root().join(folder));
        let output = command.output().context("npm audit; `cargo xtask install` installs npm")?;
        let outcome = of_npm(&String::from_utf8_lossy(&output.stdout));
        if outcome != Outcome::Passed {
            return Ok(outcome);
        }
    }
    Ok(Outcome::Passed)
}

fn of_npm(said: &str) -> Outcome {
    let Ok(report) = serde_json::from_str::<Value>(said) else {
        return Outcome::Unchecked("npm audit gave no report".to_owned());
    };
    match report["metadata"]["vulnerabilities"]["total"].as_u64() {
        Some(0) => Outcome::Passed,
        Some(_) => {
            println!("{said}");
            Outcome::Failed
        }
        None => {
            Outcome::Unchecked(report["message"].as_str().unwrap_or("npm audit gave no figures").to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_not_checked_has_not_passed() {
        let unreachable = "[ERROR] failed to fetch advisory database https://example.org: timed out";
        assert_eq!(of_deny(false, unreachable), Outcome::Unchecked(unreachable.to_owned()));
        assert_eq!(of_deny(false, "error[license]: failed"), Outcome::Failed);
        assert_eq!(of_deny(true, ""), Outcome::Passed);
        assert_eq!(of_npm(r#"{"metadata": {"vulnerabilities": {"low": 0, "total": 0}}}"#), Outcome::Passed);
        assert_eq!(of_npm(r#"{"metadata": {"vulnerabilities": {"low": 1, "total": 1}}}"#), Outcome::Failed);
        let refused = of_npm(r#"{"message": "405 Method Not Allowed", "error": {"summary": ""}}"#);
        assert_eq!(refused, Outcome::Unchecked("405 Method Not Allowed".to_owned()));
        assert!(matches!(of_npm("<html>"), Outcome::Unchecked(_)));
    }
}
