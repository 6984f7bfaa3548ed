//! Costs of the site's scenes: file size, bake time, frame time.

use super::page::Values;
use super::{VIEWS, View};
use crate::{process, web};
use anyhow::{Context, Result};
use serde_json::Value;
use std::fs;
use std::path::Path;

/// Figures from a bake's report: `file-SCENE` and `bake-SCENE`, with units.
///
/// # Errors
/// If the report cannot be read, or lacks a figure.
pub fn of_bake(scene: &str, report: &Path) -> Result<Values> {
    let text = fs::read_to_string(report).with_context(|| report.display().to_string())?;
    let report: Value = serde_json::from_str(&text).context("a bake's report")?;
    let bytes = report["file_bytes"].as_f64().context("a bake's report has no file_bytes")?;
    let stages = report["seconds"].as_array().context("a bake's report has no seconds")?;
    let seconds: f64 = stages.iter().filter_map(|stage| stage[1].as_f64()).sum();
    Ok(Values::from([
        (format!("file-{scene}"), format!("{} MB", short(bytes / 1e6))),
        (format!("bake-{scene}"), format!("{} s", short(seconds))),
    ]))
}

/// Frame times, measured in headless Chromium with the site in `out`, at the given size: `frame-VIEW` for every
/// view that is timed, in milliseconds, the `adapter`, and `frame-size`.
///
/// # Errors
/// If the measurement fails.
pub fn of_frames(out: &Path, [width, height]: [u32; 2]) -> Result<Values> {
    let mut node = web::node();
    node.arg("test/figures.mjs").arg(out).args([width, height].map(|length| length.to_string()));
    node.args(
        VIEWS.iter().filter(|view| view.is_timed).map(|View { name, scene, .. }| format!("{name}:{scene}")),
    );
    let line = process::line(&node);
    println!("> {line}");
    let json = process::quiet(&mut node).with_context(|| format!("`{line}` failed"))?;
    let found: Value = serde_json::from_str(&json).context("the frames' figures")?;
    let adapter = found["adapter"].as_str().filter(|name| !name.is_empty()).unwrap_or("an unknown adapter");
    let mut values = Values::from([
        ("adapter".to_owned(), adapter.to_owned()),
        ("frame-size".to_owned(), format!("{width} × {height}")),
    ]);
    for (name, milliseconds) in found["frames"].as_object().context("no frames were measured")? {
        let milliseconds = milliseconds.as_f64().context("a frame's time is no number")?;
        values.insert(format!("frame-{name}"), format!("{} ms", short(milliseconds)));
    }
    Ok(values)
}

/// Formats a number with two digits, or with its integer digits.
fn short(number: f64) -> String {
    if number < 9.95 { format!("{number:.1}") } else { format!("{number:.0}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([0.04, 1.25, 9.94, 9.96, 412.3].map(short), ["0.0", "1.2", "9.9", "10", "412"]);
    }
}
