//! `cargo xtask plot-estimate`: error of a bake's estimate of the remaining time, over the whole bake.
//!
//! Measured in processor seconds of one thread, independent of the machine's load.

mod record;

use crate::fidelity::given;
use crate::{process, report};
use anyhow::{Context, Result, bail};
use plotters::prelude::*;
use serde::Deserialize;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Default bakes: generated scenes, and scenes in the folder of given scenes.
const SCENES: [(&str, &str); 3] =
    [("builtin:apartment", "draft"), ("builtin:cornell-box", "draft"), ("builtin:apartment", "standard")];
const GIVEN: [(&str, &str); 7] = [
    ("country-kitchen/country-kitchen.glb", "draft"),
    ("kitchen/kitchen.glb", "draft"),
    ("living-room/living-room.glb", "draft"),
    ("sponza-crytek/sponza.gltf", "draft"),
    ("sponza-dabrovic/sponza-dabrovic.glb", "draft"),
    ("living-room/living-room.glb", "standard"),
    ("country-kitchen/country-kitchen.glb", "standard"),
];

/// Used fields of a line of `rebounce bake --json-progress`.
#[derive(Debug, Deserialize)]
struct Line {
    stage: String,
    level: Option<usize>,
    total: u64,
    processor_seconds: f64,
    processor_seconds_left: f64,
}

/// Reads the progress lines of a finished bake.
///
/// # Errors
/// If the file is not the log of a finished bake.
fn lines(log: &Path) -> Result<Vec<Line>> {
    let text = std::fs::read_to_string(log).with_context(|| log.display().to_string())?;
    let lines = text.lines().map(serde_json::from_str).collect::<Result<Vec<Line>, _>>();
    let lines = lines.with_context(|| log.display().to_string())?;
    if lines.last().is_none_or(|last| last.stage != "done") {
        bail!("{} is not the log of a bake that was done", log.display());
    }
    Ok(lines)
}

/// Course of a bake: points of (elapsed share of the time, estimated over true remaining time).
struct Course {
    name: String,
    seconds: f64,
    points: Vec<(f64, f64)>,
}

impl Course {
    /// Largest relative error of the estimate after a third of the bake, and its position. The last 3% do not
    /// count.
    fn worst(&self) -> Option<(f64, f64)> {
        let counted = self.points.iter().filter(|p| p.0 > 1.0 / 3.0 && p.0 < 0.97);
        counted.map(|p| (p.1 - 1.0, p.0)).max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
    }

    /// Relative error of the estimate at `share` of the bake.
    fn at(&self, share: f64) -> Option<f64> {
        let nearest = self.points.iter().min_by(|a, b| (a.0 - share).abs().total_cmp(&(b.0 - share).abs()));
        nearest.map(|p| p.1 - 1.0)
    }
}

/// A scene to bake with a preset, or the log of a bake.
#[derive(Debug, PartialEq)]
struct Wanted {
    scene: String,
    preset: String,
}

/// Parses the arguments: the bakes, and whether to record the bakes for the tests.
fn parse(args: &[String]) -> Result<(Vec<Wanted>, bool)> {
    let (mut wanted, mut preset, mut records) = (Vec::new(), "standard".to_owned(), false);
    let mut args = args.iter();
    while let Some(arg) = args.next() {
        match arg.as_str() {
            "--preset" => preset = args.next().context("--preset needs a value")?.clone(),
            "--record" => records = true,
            option if option.starts_with('-') => {
                bail!("there is no option {option}; there are --preset and --record")
            }
            scene => wanted.push(Wanted { scene: scene.to_owned(), preset: preset.clone() }),
        }
    }
    Ok((wanted, records))
}

/// Bakes scenes, or reads logs of bakes, draws docs/reports/estimate.svg and prints a table.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    let (mut wanted, records) = parse(args)?;
    if wanted.is_empty() {
        let of = |scene: String, preset: &str| Wanted { scene, preset: preset.to_owned() };
        wanted.extend(SCENES.iter().map(|(scene, preset)| of((*scene).to_owned(), preset)));
        wanted.extend(given().into_iter().flat_map(|folder| {
            GIVEN.map(|(scene, preset)| of(folder.join(scene).display().to_string(), preset))
        }));
    }
    let mut logs = Vec::new();
    for wanted in &wanted {
        let is_log = wanted.scene.ends_with(".jsonl");
        logs.push(if is_log { PathBuf::from(&wanted.scene) } else { bake(wanted)? });
    }
    let courses = logs.iter().map(|log| read(log)).collect::<Result<Vec<_>>>()?;
    let table = table(&courses);
    println!("{table}");
    let out = report::folder().join("estimate.svg");
    plot(&courses, &out)?;
    let figures = format!("{table}\n\n![time left over time](estimate.svg)");
    report::write("estimate", "Time left", "cargo xtask plot-estimate", &figures)?;
    if records { record::write(&logs) } else { Ok(()) }
}

/// Bakes a scene with one thread; returns the log of its progress. The report is written beside the log.
fn bake(wanted: &Wanted) -> Result<PathBuf> {
    process::run(process::cargo().args(["build", "--locked", "--release", "--package", "rebounce-cli"]))?;
    let work = process::target().join("estimate");
    std::fs::create_dir_all(&work).with_context(|| work.display().to_string())?;
    let name = wanted.scene.rsplit([':', '/', '\\']).next().unwrap_or("scene");
    let name = name.trim_end_matches(".glb").trim_end_matches(".gltf");
    let file = |end: &str| work.join(format!("{name}-{}.{end}", wanted.preset));
    let (log, output, report) = (file("jsonl"), file("rbn"), file("json"));
    let mut command = Command::new(process::target().join("release/rebounce"));
    command.args([
        "bake",
        &wanted.scene,
        "--preset",
        &wanted.preset,
        "--threads",
        "1",
        "--json-progress",
        "-o",
    ]);
    command.arg(&output).arg("--report").arg(&report).stdin(Stdio::null());
    process::run(command.stdout(File::create(&log).with_context(|| log.display().to_string())?))?;
    std::fs::remove_file(&output).with_context(|| output.display().to_string())?;
    Ok(log)
}

fn read(log: &Path) -> Result<Course> {
    let lines = lines(log)?;
    let end = lines.last().map_or(0.0, |last| last.processor_seconds);
    let before = lines.iter().filter(|line| line.processor_seconds < 0.995 * end);
    let of = |line: &Line| {
        (line.processor_seconds / end, line.processor_seconds_left / (end - line.processor_seconds))
    };
    let name = log.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Course { name, seconds: end, points: before.map(of).collect() })
}

/// Markdown table of the errors of the bakes' estimates.
fn table(courses: &[Course]) -> String {
    let percent =
        |error: Option<f64>| error.map_or("–".to_owned(), |error| format!("{:+.0}%", 100.0 * error));
    let mut lines = vec![
        "| bake | processor seconds | at a tenth | at a third | worst from there on | where |".to_owned(),
        "|---|---|---|---|---|---|".to_owned(),
    ];
    for course in courses {
        let worst = course.worst();
        lines.push(format!(
            "| {} | {:.0} | {} | {} | {} | {} |",
            course.name,
            course.seconds,
            percent(course.at(0.1)),
            percent(course.at(1.0 / 3.0)),
            percent(worst.map(|worst| worst.0)),
            worst.map_or("–".to_owned(), |worst| format!("{:.2}", worst.1)),
        ));
    }
    lines.join("\n")
}

/// Plots estimate over truth against the elapsed share of the bake; the band is the target.
fn plot(courses: &[Course], out: &Path) -> Result<()> {
    let area = SVGBackend::new(out, (760, 440)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(14)
        .x_label_area_size(42)
        .y_label_area_size(58)
        .build_cartesian_2d(0.0..1.0, 0.0..2.0)?;
    chart
        .configure_mesh()
        .x_desc("share of the bake's processor time that is over")
        .y_desc("processor time left: estimated / true")
        .draw()?;
    chart.draw_series([Rectangle::new([(1.0 / 3.0, 0.75), (1.0, 1.25)], GREEN.mix(0.15).filled())])?;
    for (k, course) in courses.iter().enumerate() {
        let colour = HSLColor(k as f64 / courses.len().max(1) as f64, 0.75, 0.42);
        let within = course.points.iter().map(|(share, ratio)| (*share, ratio.min(2.0)));
        let label = format!("{}, {:.0} s", course.name, course.seconds);
        let drawn = chart.draw_series(LineSeries::new(within, &colour))?;
        drawn.label(label).legend(move |(x, y)| PathElement::new([(x, y), (x + 14, y)], colour));
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerLeft)
        .background_style(WHITE.mix(0.8))
        .label_font(("sans-serif", 12))
        .draw()?;
    area.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_hold_for_the_scenes_behind_them() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let wanted = |scene: &str, preset: &str| Wanted { scene: scene.into(), preset: preset.into() };
        assert_eq!(
            parse(&words("a.glb --preset draft b.glb")).unwrap(),
            (vec![wanted("a.glb", "standard"), wanted("b.glb", "draft")], false)
        );
        assert!(parse(&words("--record")).unwrap().1);
        assert!(parse(&words("--preset")).is_err() && parse(&words("--threads 2")).is_err());
    }

    #[test]
    fn a_log_gives_ratios() {
        let folder = std::env::temp_dir().join(format!("rebounce-estimate-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let log = folder.join("room.jsonl");
        let line = |stage: &str, seconds: f64, left: f64| {
            format!(
                "{{\"stage\":\"{stage}\",\"level\":null,\"total\":1,\"processor_seconds\":{seconds},\
                 \"processor_seconds_left\":{left}}}\n"
            )
        };
        let lines = line("preparing", 0.0, 20.0) + &line("tracing links", 5.0, 4.0);
        std::fs::write(&log, &lines).unwrap();
        assert!(read(&log).is_err(), "it is not done");
        std::fs::write(&log, lines + &line("assembling", 9.8, 0.5) + &line("done", 10.0, 0.0)).unwrap();
        let course = read(&log).unwrap();
        assert_eq!((course.name.as_str(), course.seconds, course.points.len()), ("room", 10.0, 3));
        assert_eq!(course.points[..2], [(0.0, 2.0), (0.5, 0.8)]);
        let (error, share) = course.worst().unwrap();
        assert!((error + 0.2).abs() < 1e-9 && share == 0.5, "the end does not count");
        assert!(table(&[course]).ends_with("| room | 10 | +100% | -20% | -20% | 0.50 |"));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
