//! `cargo xtask bench-kernels`: instruction counts of a bake's kernels, by valgrind's callgrind. Counts do not
//! depend on the machine's load.

use crate::install::{self, Need};
use crate::{process, report};
use anyhow::{Context, Result, bail, ensure};
use std::collections::HashMap;
use std::process::Stdio;

const VALGRIND: [Need; 1] = [Need {
    package: "valgrind",
    why: "counts instructions",
    present: || process::find(&["valgrind"]).is_some(),
}];

/// Module of the benchmark's functions, and the function around all counted calls.
const MODULE: &str = "kernels::";
const COUNTED: &str = "kernels::counted";

/// Counts instructions, and prints a table.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    if let Some(arg) = args.first() {
        bail!("bench-kernels takes no arguments, not {arg}");
    }
    install::ensure(&VALGRIND)?;
    let work = process::target().join("kernels");
    std::fs::create_dir_all(&work).with_context(|| work.display().to_string())?;
    let profile = work.join("callgrind.out");
    let valgrind = [
        "valgrind".to_owned(),
        "--quiet".to_owned(),
        "--tool=callgrind".to_owned(),
        "--collect-atstart=no".to_owned(),
        format!("--toggle-collect=*{COUNTED}*"),
        format!("--callgrind-out-file={}", profile.display()),
    ];
    let runner = format!("target.'cfg(all())'.runner={}", serde_json::to_string(&valgrind)?);
    let mut command = process::cargo();
    command.args(["bench", "--package", "rebounce-benches", "--bench", "kernels", "--config", &runner]);
    command.args(["--", "--count"]);
    println!("> {}", process::line(&command));
    let output = command.stdin(Stdio::null()).stderr(Stdio::inherit()).output();
    let output = output.context("the benchmark could not be started")?;
    ensure!(output.status.success(), "the benchmark failed ({})", output.status);
    let profile = std::fs::read_to_string(&profile).with_context(|| profile.display().to_string())?;
    let table = table(&String::from_utf8_lossy(&output.stdout), &profile)?;
    println!("{table}");
    report::write("kernels", "Instructions of the kernels", "cargo xtask bench-kernels", &table)
}

/// Table of instructions per unit, from the unit counts printed by the benchmark and the profile of valgrind.
fn table(said: &str, profile: &str) -> Result<String> {
    let costs = costs(profile);
    let mut lines = vec!["| kernel | of a | instructions |".to_owned(), "|---|---|---|".to_owned()];
    for counted in said.lines().filter_map(|line| line.strip_prefix("counted ")) {
        let mut words = counted.splitn(3, ' ');
        let (name, units) = (words.next().context("no name")?, words.next().context("no number")?);
        let units: u64 = units.parse().with_context(|| counted.to_owned())?;
        ensure!(units > 0, "{name} did nothing");
        let instructions = costs.get(&format!("{MODULE}{name}"));
        let instructions = instructions.with_context(|| format!("{COUNTED} did not call {MODULE}{name}"))?;
        let each = *instructions as f64 / units as f64;
        let each = if each < 100.0 { format!("{each:.1}") } else { format!("{each:.0}") };
        lines.push(format!("| {name} | {} | {each} |", words.next().unwrap_or_default()));
    }
    ensure!(lines.len() > 2, "the benchmark said nothing of what it did:\n{said}");
    Ok(lines.join("\n"))
}

/// Inclusive costs of the calls from [`COUNTED`], by called function. A profile gives a function's name once, and
/// its number afterwards.
fn costs(profile: &str) -> HashMap<String, u64> {
    let mut names: HashMap<&str, &str> = HashMap::new();
    let mut costs = HashMap::new();
    let (mut caller, mut called) = ("", None);
    let mut lines = profile.lines();
    while let Some(line) = lines.next() {
        let (what, function) = line.split_once("fn=").unwrap_or(("-", ""));
        if what.is_empty() || what == "c" {
            let (number, name) = function.split_once(' ').unwrap_or((function, ""));
            if !name.is_empty() {
                names.insert(number, name);
            }
            let name = names.get(number).copied().unwrap_or_default();
            if what == "c" {
                called = Some(name);
            } else {
                caller = name;
            }
        } else if line.starts_with("calls=") {
            let cost = lines.next().and_then(|line| line.split_whitespace().nth(1)?.parse::<u64>().ok());
            if let (Some(called), Some(cost), true) = (called.take(), cost, caller.starts_with(COUNTED)) {
                *costs.entry(called.to_owned()).or_default() += cost;
            }
        }
    }
    costs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_have_what_their_calls_took() {
        let profile = "fn=(1) kernels::walk\n5 70\ncfn=(2) deeper\ncalls=9 3\n6 900\n\n\
                       fn=(3) kernels::counted\n1 4\ncfn=(1)\ncalls=1 5\n* 1000\ncfi=(7) other.rs\n\
                       cfn=(4) kernels::cast\ncalls=1 8\n* 12\n+3 20\ncfn=(1)\ncalls=1 5\n* 4000\n";
        let said = "Benchmarking\ncounted walk 10 ray, to the nearest hit\ncounted cast 8 ray\n";
        let table = table(said, profile).unwrap();
        assert!(table.ends_with("| walk | ray, to the nearest hit | 500 |\n| cast | ray | 1.5 |"), "{table}");
        assert!(super::table("counted deeper 1 ray\n", profile).is_err(), "not called by what is counted");
        assert!(super::table("counted walk 0 ray\n", profile).is_err() && super::table("", profile).is_err());
    }
}
