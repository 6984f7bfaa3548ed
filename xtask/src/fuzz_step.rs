//! `cargo xtask fuzz-step`: reads damaged STEP files with the reader of CAD models: each must be read or refused with a reason,
//! without panic, in bounded time and memory.

use crate::process;
use anyhow::{Context, Result, bail};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::Instant;

/// Copies that one process reads.
const BATCH: u64 = 5000;
/// Processes at a time.
const PROCESSES: u64 = 2;

#[derive(Debug, PartialEq)]
struct Options {
    files: u64,
    seed: u64,
    /// Folder with more STEP files to damage.
    from: Option<PathBuf>,
}

fn parse(args: &[String]) -> Result<Options> {
    let mut options = Options { files: 1_000_000, seed: 1, from: None };
    let mut args = args.iter();
    while let Some(name) = args.next() {
        let mut value = || args.next().with_context(|| format!("{name} needs a value"));
        match name.as_str() {
            "--files" => options.files = value()?.parse().context("--files needs a number")?,
            "--seed" => options.seed = value()?.parse().context("--seed needs a number")?,
            "--from" => options.from = Some(value()?.into()),
            other => bail!("there is no option {other}; there are --files, --seed and --from"),
        }
    }
    Ok(options)
}

/// What came of the copies.
#[derive(Debug, Default, PartialEq)]
struct Results {
    /// How many of each kind.
    counts: BTreeMap<String, u64>,
    /// Longest processor time, microseconds, and the number of that copy.
    slowest: (u64, u64),
    /// Most memory, bytes, and the number of that copy.
    largest: (u64, u64),
    /// Numbers of copies at fault, and what the fault is.
    faults: Vec<(u64, String)>,
}

impl Results {
    /// Adds what a process printed.
    fn add(&mut self, printed: &str) -> Result<()> {
        for line in printed.lines() {
            let (word, rest) = line.split_once(' ').context("an empty line of results")?;
            let (number, rest) = rest.split_once(' ').context("a result without number")?;
            let number: u64 = number.parse().context("a result's number")?;
            match word {
                "count" => *self.counts.entry(rest.into()).or_default() += number,
                "slowest" => self.slowest = self.slowest.max((number, rest.parse()?)),
                "largest" => self.largest = self.largest.max((number, rest.parse()?)),
                "at" => self.faults.push((number, rest.into())),
                other => bail!("unknown result {other}"),
            }
        }
        Ok(())
    }
}

/// Reads damaged files and prints what came of them; those at fault stay in target/fuzz-step.
///
/// # Errors
/// If a file is at fault.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    let folder = process::target().join("fuzz-step");
    if folder.exists() {
        std::fs::remove_dir_all(&folder).with_context(|| folder.display().to_string())?;
    }
    let texts = folder.join("texts");
    std::fs::create_dir_all(&texts).with_context(|| texts.display().to_string())?;
    // The reader's own tests write their texts.
    let mut tests = process::cargo();
    tests.args(["test", "--package", "rebounce-cad", "--features", "step", "--lib", "step::"]);
    process::run(tests.env("REBOUNCE_STEP_TEXTS", &texts))?;
    let mut files = step_files(&texts)?;
    if let Some(from) = &options.from {
        files.extend(step_files(from)?);
    }
    let build = ["build", "--package", "rebounce-cad", "--features", "step", "--example", "fuzz_step"];
    process::run(process::cargo().args(build))?;
    println!("{} copies of {} files", options.files, files.len());

    let began = Instant::now();
    let (next, results) = (Mutex::new(0), Mutex::new(Results::default()));
    let fuzz = Fuzz { seed: options.seed, folder, files };
    let work = || -> Result<()> {
        loop {
            let first = {
                let mut next = next.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
                let first = *next;
                *next += BATCH;
                first
            };
            if first >= options.files {
                return Ok(());
            }
            let found = fuzz.batch(first, BATCH.min(options.files - first))?;
            let mut results = results.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
            for printed in found {
                results.add(&printed)?;
            }
            println!("{first} and on: {} at fault so far", results.faults.len());
        }
    };
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..PROCESSES).map(|_| scope.spawn(work)).collect();
        threads.into_iter().try_for_each(|thread| match thread.join() {
            Ok(result) => result,
            Err(_) => bail!("a thread ended by a panic"),
        })
    })?;
    let results = results.into_inner().unwrap_or_else(|poisoned| poisoned.into_inner());
    report(&results, &fuzz.folder, began.elapsed().as_secs_f64())
}

/// Prints the results.
fn report(results: &Results, folder: &Path, seconds: f64) -> Result<()> {
    for (kind, count) in &results.counts {
        println!("{count:>9} {kind}");
    }
    println!(
        "slowest: {:.3} s (copy {}); most memory: {:.1} MB (copy {}); {seconds:.0} s in all",
        results.slowest.0 as f64 * 1e-6,
        results.slowest.1,
        results.largest.0 as f64 / 1e6,
        results.largest.1,
    );
    for (index, fault) in &results.faults {
        println!("copy {index}: {fault}");
    }
    if results.faults.is_empty() {
        return Ok(());
    }
    bail!("{} files at fault are in {}", results.faults.len(), folder.display())
}

/// The STEP files in a folder and the folders in it, in the order of their names.
fn step_files(folder: &Path) -> Result<Vec<PathBuf>> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
        let path = entry?.path();
        let extension = path.extension().unwrap_or_default().to_ascii_lowercase();
        if path.is_dir() {
            found.extend(step_files(&path)?);
        } else if extension == "step" || extension == "stp" {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// A campaign.
struct Fuzz {
    seed: u64,
    folder: PathBuf,
    files: Vec<PathBuf>,
}

impl Fuzz {
    /// The program with its first arguments.
    fn command(&self, first: &str, count: u64) -> Command {
        let mut command = Command::new(process::target().join("debug/examples/fuzz_step"));
        command.args([first, &count.to_string(), &self.seed.to_string()]).arg(&self.folder);
        command.args(&self.files).stdin(Stdio::null()).stderr(Stdio::null());
        command
    }

    /// Reads some copies; what processes printed. Where one ends by a fault that cannot be caught, as an overflow of the stack or
    /// of memory, the copy that it was at is written, and those before and after it are read by themselves.
    fn batch(&self, first: u64, count: u64) -> Result<Vec<String>> {
        if count == 0 {
            return Ok(Vec::new());
        }
        let output = self.command(&first.to_string(), count).output().context("starting fuzz_step")?;
        let at = self.folder.join(format!("at-{first}"));
        let current = std::fs::read_to_string(&at).with_context(|| at.display().to_string())?;
        std::fs::remove_file(&at).with_context(|| at.display().to_string())?;
        if output.status.success() {
            return Ok(vec![String::from_utf8(output.stdout)?]);
        }
        let current: u64 = current.trim().parse().context("number of the copy at fault")?;
        process::run(&mut self.command("--write", current))?;
        let mut printed = self.batch(first, current - first)?;
        let fault = format!("fault: the process ended ({})", output.status);
        printed.push(format!("at {current} {fault}\ncount 1 {fault}"));
        printed.extend(self.batch(current + 1, first + count - current - 1)?);
        Ok(printed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let options = parse(&words("--seed 9 --files 7 --from a/b")).unwrap();
        assert_eq!(options, Options { files: 7, seed: 9, from: Some("a/b".into()) });
        assert_eq!(parse(&[]).unwrap().files, 1_000_000);
        assert!(parse(&words("--files")).is_err() && parse(&words("--files many")).is_err());
        assert!(parse(&words("--file 7")).is_err());
    }

    #[test]
    fn results_add_up() {
        let mut results = Results::default();
        results.add("count 5 read\nslowest 70 3\nlargest 900 2\n").unwrap();
        results
            .add("at 9 fault: panic\ncount 2 read\ncount 1 fault: panic\nslowest 60 8\nlargest 1000 9")
            .unwrap();
        let counts = BTreeMap::from([("read".to_owned(), 7), ("fault: panic".to_owned(), 1)]);
        let faults = vec![(9, "fault: panic".to_owned())];
        assert_eq!(results, Results { counts, slowest: (70, 3), largest: (1000, 9), faults });
        assert!(results.add("hearsay 1 2").is_err());
    }
}
