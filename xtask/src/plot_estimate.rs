//! `cargo xtask plot-estimate`: how far a bake's estimate of the time left is from the truth, all the way.

use crate::fidelity::given;
use crate::process;
use anyhow::{Context, Result, bail};
use plotters::prelude::*;
use serde::Deserialize;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What of a line of `rebounce bake --json-progress` is read.
#[derive(Debug, Deserialize)]
struct Line {
    stage: String,
    seconds: f64,
    seconds_left: f64,
}

/// One bake: shares of its time that were over, and what was then estimated to be left over what was.
struct Course {
    name: String,
    seconds: f64,
    points: Vec<(f64, f64)>,
}

/// Bakes scenes, or reads logs of bakes, and draws docs/estimate.svg.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    let mut wanted: Vec<String> = args.to_vec();
    if wanted.is_empty() {
        wanted.push("builtin:apartment".to_owned());
        wanted.extend(
            given().map(|folder| folder.join("country-kitchen/country-kitchen.glb").display().to_string()),
        );
    }
    let mut courses = Vec::new();
    for scene in &wanted {
        let log = if scene.ends_with(".jsonl") { PathBuf::from(scene) } else { bake(scene)? };
        let course = read(&log)?;
        let worst = course.points.iter().filter(|p| p.0 > 1.0 / 3.0 && p.0 < 0.97);
        let worst = worst.map(|p| (p.1 - 1.0).abs()).fold(0.0, f64::max);
        println!(
            "{}: {:.0} s; off by {:.0}% at most after a third",
            course.name,
            course.seconds,
            100.0 * worst
        );
        courses.push(course);
    }
    let out = process::root().join("docs/estimate.svg");
    plot(&courses, &out)?;
    println!("wrote {}", out.display());
    Ok(())
}

/// Bakes a scene at the usual preset; the log of its progress.
fn bake(scene: &str) -> Result<PathBuf> {
    process::run(process::cargo().args(["build", "--locked", "--release", "--package", "rebounce"]))?;
    let work = process::target().join("estimate");
    std::fs::create_dir_all(&work).with_context(|| work.display().to_string())?;
    let name =
        scene.rsplit([':', '/', '.']).find(|part| !part.is_empty() && *part != "glb").unwrap_or("scene");
    let (log, output) = (work.join(format!("{name}.jsonl")), work.join(format!("{name}.rbn")));
    let mut command = Command::new(process::target().join("release/rebounce"));
    command.args(["bake", scene, "--json-progress", "-o"]).arg(output).stdin(Stdio::null());
    process::run(command.stdout(File::create(&log).with_context(|| log.display().to_string())?))?;
    Ok(log)
}

fn read(log: &Path) -> Result<Course> {
    let text = std::fs::read_to_string(log).with_context(|| log.display().to_string())?;
    let lines: Vec<Line> = text
        .lines()
        .map(serde_json::from_str)
        .collect::<Result<_, _>>()
        .with_context(|| log.display().to_string())?;
    let end = match lines.last() {
        Some(last) if last.stage == "done" => last.seconds,
        _ => bail!("{} is not the log of a bake that was done", log.display()),
    };
    let before = lines.iter().filter(|line| line.seconds < 0.995 * end);
    let points = before.map(|line| (line.seconds / end, line.seconds_left / (end - line.seconds))).collect();
    let name = log.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    Ok(Course { name, seconds: end, points })
}

/// Estimate over truth by the share of the bake that is over; the band is what is aimed at.
fn plot(courses: &[Course], out: &Path) -> Result<()> {
    let area = SVGBackend::new(out, (700, 380)).into_drawing_area();
    area.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&area)
        .margin(14)
        .x_label_area_size(42)
        .y_label_area_size(58)
        .build_cartesian_2d(0.0..1.0, 0.0..2.0)?;
    chart
        .configure_mesh()
        .x_desc("share of the bake that is over")
        .y_desc("time left: estimated / true")
        .draw()?;
    chart.draw_series([Rectangle::new([(1.0 / 3.0, 0.75), (1.0, 1.25)], GREEN.mix(0.15).filled())])?;
    for (course, colour) in courses.iter().zip([BLUE, RED, MAGENTA, BLACK].iter().cycle()) {
        let within = course.points.iter().map(|(share, ratio)| (*share, ratio.min(2.0)));
        chart.draw_series(LineSeries::new(within, colour))?;
        let at = course.points.iter().rev().find(|p| p.0 < 0.6).map_or(1.0, |p| p.1.min(1.9));
        let label = format!("{}, {:.0} s", course.name, course.seconds);
        chart.draw_series([Text::new(
            label,
            (0.6, at + 0.12),
            ("sans-serif", 14).into_font().color(colour),
        )])?;
    }
    area.present()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_log_gives_ratios() {
        let folder = std::env::temp_dir().join(format!("rebounce-estimate-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let log = folder.join("room.jsonl");
        let line = |stage: &str, seconds: f64, left: f64| {
            format!(
                "{{\"stage\":\"{stage}\",\"level\":null,\"seconds\":{seconds},\"seconds_left\":{left}}}\n"
            )
        };
        std::fs::write(&log, line("preparing", 0.0, 20.0) + &line("tracing links", 5.0, 4.0)).unwrap();
        assert!(read(&log).is_err(), "it is not done");
        let lines =
            line("preparing", 0.0, 20.0) + &line("tracing links", 5.0, 4.0) + &line("done", 10.0, 0.0);
        std::fs::write(&log, lines).unwrap();
        let course = read(&log).unwrap();
        assert_eq!(course.points, [(0.0, 2.0), (0.5, 0.8)]);
        assert_eq!((course.name.as_str(), course.seconds), ("room", 10.0));
        std::fs::remove_dir_all(folder).unwrap();
    }
}
