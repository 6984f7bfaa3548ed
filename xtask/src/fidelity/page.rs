//! docs/reports/fidelity.md and its plot.

use super::measure::{Comparison, Measured};
use super::path::Steps;
use anyhow::Result;
use plotters::prelude::*;
use std::fmt;
use std::path::Path;

/// Measurements of the page.
#[derive(Default)]
pub struct Page {
    /// Scenes at presets.
    pub scenes: Vec<Measured>,
    /// The path tracer against other renderers' references, by scene.
    pub tracer: Vec<(String, Comparison)>,
    /// Light leaks through a wall, by preset.
    pub leaks: Vec<(String, f64)>,
    /// Steps of a moving lamp, by preset, and of the path tracer.
    pub steps: Vec<(String, Steps)>,
    /// Bakes by ε.
    pub curve: Vec<(f32, Measured)>,
}

const HEAD: &str = "\
Bounced light of baked scenes against path-traced references. *Error* is the root mean square
difference over the reference's root mean square (0 is perfect), *bias* the difference of the means,
*p95* the 95th percentile of the difference over blocks of 8 by 8 pixels; noise of the references is
cancelled out. *FLIP* is how much of the difference an eye notices that flips between both,
tone-mapped (Andersson et al. 2020; 0 to 1, with what is left of the references' noise in it).
*Spots*, where the picture has bare walls: of what is of their size there, standard deviation and
99.5th percentile on each wall, in thousandths of a stop (`compare --spots`; 15, which is 1%, begins
to be seen). No parameter set by hand. Scenes that came with references of another renderer (Mitsuba
3) are held to these, generated ones to the project's own path tracer. `rebounce compare` takes one
measurement.

";

impl fmt::Display for Page {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(HEAD)?;
        writeln!(
            f,
            "| scene | preset | error | bias | p95 | FLIP | spots | seconds | peak memory | file | links | functions |"
        )?;
        writeln!(f, "|---|---|---|---|---|---|---|---|---|---|---|---|")?;
        for m in &self.scenes {
            let (c, r) = (&m.comparison, &m.report);
            writeln!(
                f,
                "| {} ({} k triangles) | {} | {} | {} | {:.0} | {:.0} MB | {:.0} MB | {} | {} k |",
                m.scene,
                r.triangles.div_ceil(1000),
                m.preset,
                cells(c),
                c.spots_cell(),
                seconds(m),
                r.peak_memory_bytes as f64 / 1e6,
                r.file_bytes as f64 / 1e6,
                millions(m),
                r.functions / 1000,
            )?;
        }
        let over: Vec<String> = self.scenes.iter().filter(|m| is_over(m)).map(named).collect();
        if over.is_empty() {
            writeln!(f, "\nEvery scene keeps the error that its preset is made for ({PROMISES}).")?;
        } else {
            writeln!(f, "\nOver the error that their preset is made for ({PROMISES}):\n")?;
            over.iter().try_for_each(|scene| writeln!(f, "* {scene}"))?;
        }
        if !self.tracer.is_empty() {
            f.write_str(TRACER)?;
            for (name, c) in &self.tracer {
                writeln!(f, "| {name} | {:+.3} |", c.bias)?;
            }
        }
        f.write_str(PICTURES)?;
        let generated = self.scenes.iter().filter(|m| m.is_generated);
        let mut shown: Vec<&str> = generated.map(|m| m.scene.as_str()).collect();
        shown.dedup();
        for scene in shown {
            writeln!(f, "\n![{scene}: path traced, ours, difference](fidelity/{scene}.png)")?;
        }
        f.write_str(LEAKS)?;
        for (preset, leak) in &self.leaks {
            writeln!(f, "| {preset} | {leak:.6} |")?;
        }
        f.write_str(STEPS)?;
        for (name, steps) in &self.steps {
            writeln!(f, "| {name} | {:.4} | {:.4} |", steps.whole, steps.blocks)?;
        }
        f.write_str(CURVE)?;
        for (epsilon, m) in &self.curve {
            writeln!(
                f,
                "| {epsilon} | {} | {:+.3} | {:.1} | {} |",
                m.comparison.error_cell(),
                m.comparison.bias,
                seconds(m),
                millions(m)
            )?;
        }
        f.write_str("\n![error over links and over seconds](fidelity/epsilon.svg)\n")
    }
}

const PICTURES: &str = "
## Pictures

Path traced, ours, and the difference four times enlarged: red is too bright, blue too dark.
";

const TRACER: &str = "
## The path tracer itself

`rebounce reference`, 64 samples a pixel, against the same references. Its tests hold it against
closed forms, too: a furnace, a point light over a plane, two parallel squares.

| scene | bias |
|---|---|
";

const LEAKS: &str = "
## Light through walls

Two rooms of 4 m with a wall of 5 cm between them and no door, `builtin:two-rooms`; floor, ceiling
and long walls run on past the wall. Mean bounced light in the dark room over that in the lit one:

| preset | leak |
|---|---|
";

const STEPS: &str = "
## A moving light

A spot light goes along the library's shelves in 200 steps, its shadows sweep over everything. The
largest change of the bounced light from one step to the next: root mean square over the whole
picture, and 95th percentile over blocks of 8 by 8 pixels. Where ours is no larger than the path
tracer's, nothing pops.

| | whole picture | blocks |
|---|---|---|
";

const CURVE: &str = "
## Error and cost

The library at `draft`, by the link threshold ε (a share of what the scene's surfaces reflect):

| ε | error | bias | seconds | links |
|---|---|---|---|---|
";

/// Source of the presets' promises: `rebounce bake --help`.
const PROMISES: &str = "`bake --help`";

/// Whether the error is over the error promised by the bake's preset.
fn is_over(m: &Measured) -> bool {
    m.comparison.error() > m.report.promised_error
}

fn named(m: &Measured) -> String {
    format!("{} at {}", m.scene, m.preset)
}

/// Error, bias, p95 and FLIP as cells of a table.
fn cells(c: &Comparison) -> String {
    format!("{} | {:+.3} | {:.2} | {:.3}", c.error_cell(), c.bias, c.p95, c.flip)
}

fn seconds(m: &Measured) -> f64 {
    m.report.seconds.iter().map(|(_, s)| s).sum()
}

fn millions(m: &Measured) -> String {
    format!("{:.1} M", (m.report.links + m.report.later_links) as f64 / 1e6)
}

/// Draws error over links and over seconds, both axes logarithmic.
///
/// # Errors
/// If the picture cannot be drawn or written.
pub fn plot(curve: &[(f32, Measured)], out: &Path) -> Result<()> {
    let area = SVGBackend::new(out, (900, 380)).into_drawing_area();
    area.fill(&WHITE)?;
    let (left, right) = area.split_horizontally(450);
    let links = |m: &Measured| (m.report.links + m.report.later_links) as f64;
    for (half, name) in [(left, "links"), (right, "seconds")] {
        let cost = |m: &Measured| if name == "links" { links(m) } else { seconds(m) };
        let points: Vec<(f64, f64)> = curve.iter().map(|(_, m)| (cost(m), m.comparison.error())).collect();
        let range = |values: &dyn Fn(&(f64, f64)) -> f64| {
            let low = points.iter().map(values).fold(f64::INFINITY, f64::min);
            let high = points.iter().map(values).fold(0.0, f64::max);
            0.8 * low..1.25 * high
        };
        let mut chart = ChartBuilder::on(&half)
            .margin(14)
            .x_label_area_size(42)
            .y_label_area_size(58)
            .build_cartesian_2d(range(&|p| p.0).log_scale(), range(&|p| p.1).log_scale())?;
        chart.configure_mesh().x_desc(name).y_desc("error").draw()?;
        chart.draw_series(LineSeries::new(points.clone(), &BLUE))?;
        chart.draw_series(points.iter().map(|p| Circle::new(*p, 3, BLUE.filled())))?;
    }
    area.present()?;
    Ok(())
}
