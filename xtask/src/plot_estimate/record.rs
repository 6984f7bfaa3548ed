//! Records the times of a bake's parts for the tests of the estimate: `baker/src/bake/estimate/courses.json`.

use super::{Line, lines};
use crate::process;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// Used fields of a bake's report.
#[derive(Deserialize)]
struct Report {
    scene: String,
    preset: String,
    triangles: u64,
    ray_triangles: u64,
    coarse_entries: u64,
    levels: Vec<Level>,
}

#[derive(Deserialize)]
struct Level {
    functions: u64,
}

/// A part of a bake: units of work, and seconds of one processor.
#[derive(Debug, PartialEq, Serialize)]
struct Part {
    stage: String,
    level: Option<usize>,
    units: u64,
    seconds: f64,
}

/// A bake.
#[derive(Serialize)]
struct Course {
    scene: String,
    preset: String,
    triangles: u64,
    ray_triangles: u64,
    functions: Vec<u64>,
    coarse_entries: u64,
    parts: Vec<Part>,
}

/// Parts of a bake, in order: a part ends at the first line of the next part. For point placement, the number of
/// units is the final number of functions of the level.
fn parts(lines: &[Line], functions: &[u64]) -> Vec<Part> {
    let begins = |pair: &&[Line]| (&pair[0].stage, pair[0].level) != (&pair[1].stage, pair[1].level);
    let mut before = 0.0;
    let ends = lines.windows(2).filter(begins);
    let part = |pair: &[Line]| {
        let (last, next) = (&pair[0], pair[1].processor_seconds);
        let placed = last.level.filter(|_| last.stage == "placing points").map(|level| functions[level]);
        let seconds = ((next - before) * 1e4).round() / 1e4;
        before = next;
        Part { stage: last.stage.clone(), level: last.level, units: placed.unwrap_or(last.total), seconds }
    };
    ends.map(part).collect()
}

fn course(log: &Path) -> Result<Course> {
    let report = log.with_extension("json");
    let text = std::fs::read_to_string(&report).with_context(|| report.display().to_string())?;
    let Report { scene, preset, triangles, ray_triangles, coarse_entries, levels } =
        serde_json::from_str(&text).with_context(|| report.display().to_string())?;
    let functions: Vec<u64> = levels.iter().map(|level| level.functions).collect();
    let parts = parts(&lines(log)?, &functions);
    Ok(Course { scene, preset, triangles, ray_triangles, functions, coarse_entries, parts })
}

/// Records bakes; the report of a bake is beside its log.
///
/// # Errors
/// If a file cannot be read or written.
pub fn write(logs: &[PathBuf]) -> Result<()> {
    let courses = logs.iter().map(|log| course(log)).collect::<Result<Vec<_>>>()?;
    let out = process::root().join("baker/src/bake/estimate/courses.json");
    let text = serde_json::to_string_pretty(&courses)? + "\n";
    std::fs::write(&out, text).with_context(|| out.display().to_string())?;
    println!("wrote {}", out.display());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_lasts_until_the_next_begins() {
        let line = |stage: &str, level, total, processor_seconds| Line {
            stage: stage.to_owned(),
            level,
            total,
            processor_seconds,
            processor_seconds_left: 0.0,
        };
        let lines = [
            line("preparing", None, 30, 0.0),
            line("placing points", Some(0), 148, 0.1),
            line("placing points", Some(0), 148, 0.2),
            line("tracing links", Some(0), 4000, 0.4),
            line("done", None, 0, 1.0),
        ];
        let part =
            |stage: &str, level, units, seconds| Part { stage: stage.to_owned(), level, units, seconds };
        let expected = [
            part("preparing", None, 30, 0.1),
            part("placing points", Some(0), 158, 0.3),
            part("tracing links", Some(0), 4000, 0.6),
        ];
        assert_eq!(parts(&lines, &[158]), expected);
    }
}
