//! `cargo xtask bench-antiradiance`: antiradiance against the path tracer, by bins, by elements and by iteration.
//!
//! Scenes and settings are after Figs. 5 and 12 to 14 of Dachsbacher et al. 2007.

mod page;
mod plot;
mod record;

use crate::{process, report};
use anyhow::{Result, bail};
use plot::{Chart, Line};
use record::{Recorder, Solved};

/// Numbers of bins, and of elements, that are compared.
const BINS: [usize; 5] = [64, 128, 256, 512, 1024];
const ELEMENTS: [usize; 4] = [3_000, 6_000, 12_000, 24_000];
/// What the other stays at.
const BINS_OF_ELEMENTS: usize = 256;
const ELEMENTS_OF_BINS: usize = 8_000;
/// ε of radiosity: the default, and one for shelves, where light varies much in little space.
const EPSILONS: [&str; 2] = ["0.25", "0.05"];
/// Scenes, and the bins and elements of their figure in the paper.
const SCENES: [(&str, usize, usize); 2] = [("office", 208, 45_000), ("maze", 1024, 6_088)];
/// Iterations of the convergence plot: arguments of the command, how they are called, and steps of an iteration.
const ITERATIONS: [(&[&str], &str, usize); 4] = [
    (&["--iteration", "symmetric"], "symmetric", 1),
    (&["--iteration", "asymmetric", "--antiradiance-steps", "4"], "asymmetric, 4 steps", 4),
    (&["--iteration", "asymmetric", "--antiradiance-steps", "8"], "asymmetric, 8 steps", 8),
    (&["--iteration", "ordered"], "ordered", 1),
];
/// Iterations, elements and bins of the convergence plot.
const COUNT: usize = 100;
const ELEMENTS_OF_STEPS: usize = 6_000;
const BINS_OF_STEPS: usize = 128;

/// Measures and writes docs/reports/antiradiance.md with its plots. `--spp N`: samples a pixel of each of both references. `--page`
/// measures the page instead.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    let spp = match args {
        [] => "512",
        [option, spp] if option == "--spp" => spp,
        [option] if option == "--page" => return page::run(),
        _ => bail!("there are --spp N, samples a pixel of each reference, and --page"),
    };
    process::run(process::cargo().args([
        "build",
        "--locked",
        "--release",
        "--package",
        "rebounce-cli",
        "--no-default-features",
    ]))?;
    let recorder = Recorder::new(spp)?;
    let mut page = vec![format!(
        "Bounced light in pictures of 240 by 180 pixels against the path tracer (two references of {spp}\n\
         samples a pixel): relative RMS, without the references' noise; bias as a share of the mean.\n\
         Elements are patches and clusters. Times are those of a step, of all threads."
    )];
    let (mut by_bins, mut by_elements) = (Vec::new(), Vec::new());
    for (scene, bins, elements) in SCENES {
        let solve = |bins: usize, elements: usize| {
            let (bins, elements) = (bins.to_string(), elements.to_string());
            recorder.measured(scene, &["--bins", &bins, "--elements", &elements])
        };
        let paper = solve(bins, elements)?;
        let other: Vec<String> =
            EPSILONS.iter().map(|epsilon| recorder.radiosity(scene, epsilon)).collect::<Result<_>>()?;
        page.push(format!("## {scene}\n\nAt the paper's settings, and by radiosity with visibility:"));
        page.push(format!("{}\n{}\n{}", Solved::HEAD, paper.row(), other.join("\n")));
        let rows: Vec<Solved> =
            BINS.iter().map(|bins| solve(*bins, ELEMENTS_OF_BINS)).collect::<Result<_>>()?;
        page.push(format!("By bins:\n\n{}", table(&rows)));
        by_bins.push(Line::new(scene, rows.iter().map(|row| (row.bins(), row.error))));
        let rows: Vec<Solved> =
            ELEMENTS.iter().map(|elements| solve(BINS_OF_ELEMENTS, *elements)).collect::<Result<_>>()?;
        page.push(format!("By elements:\n\n{}", table(&rows)));
        by_elements.push(Line::new(scene, rows.iter().map(|row| (row.elements(), row.error))));
    }
    for (name, x, lines) in [("bins", "bins", &by_bins), ("elements", "elements", &by_elements)] {
        Chart { x, y: "relative RMS error", lines, is_logarithmic: [true, false] }
            .draw(&recorder.plot(name))?;
    }
    page.push(format!(
        "![Error by bins]({}/bins.svg)\n\n![Error by elements]({0}/elements.svg)",
        record::FOLDER
    ));
    page.push(convergence(&recorder)?);
    report::write("antiradiance", "Antiradiance", &line(args), &page.join("\n\n"))
}

fn line(args: &[String]) -> String {
    ["cargo xtask bench-antiradiance"]
        .into_iter()
        .chain(args.iter().map(String::as_str))
        .collect::<Vec<_>>()
        .join(" ")
}

fn table(rows: &[Solved]) -> String {
    let rows: Vec<String> = rows.iter().map(Solved::row).collect();
    format!("{}\n{}", Solved::HEAD, rows.join("\n"))
}

/// The part on the iterations: a plot for each scene.
fn convergence(recorder: &Recorder) -> Result<String> {
    let mut page = vec![
        format!(
            "## Iterations\n\nDifference of the irradiance after each step from that after the last one, a share\n\
             of it, with {BINS_OF_STEPS} bins and {ELEMENTS_OF_STEPS} elements; and relative RMS of the pictures after {COUNT}\n\
             iterations, of 4 or 8 steps if asymmetric, from the ordered iteration's."
        ),
        String::new(),
        "| scene | iteration | difference after 4 steps | 10 | 40 | from the ordered one |".to_owned(),
        "|---|---|---|---|---|---|".to_owned(),
    ];
    let mut plots = Vec::new();
    for (scene, ..) in SCENES {
        let mut lines = Vec::new();
        let (bins, elements) = (BINS_OF_STEPS.to_string(), ELEMENTS_OF_STEPS.to_string());
        let ends = recorder.steps(
            scene,
            &["--bins", &bins, "--elements", &elements],
            &ITERATIONS.map(|(args, _, steps)| (args, COUNT * steps)),
        )?;
        for ((_, name, _), own) in ITERATIONS.iter().zip(ends) {
            let said = |difference: f64| match difference {
                // Where the light grows, all before is nothing beside the end.
                _ if own.from_last.is_nan() || own.from_last > 10.0 => "diverges".to_owned(),
                difference => format!("{difference:.1e}"),
            };
            let at = |step: usize| said(own.differences.get(step - 1).copied().unwrap_or(f64::NAN));
            page.push(format!(
                "| {scene} | {name} | {} | {} | {} | {} |",
                at(4),
                at(10),
                at(40),
                said(own.from_last)
            ));
            // Rounding ends below 1e-6.
            let shown = (1..=COUNT).zip(&own.differences).filter(|(_, own)| (1e-6..1e3).contains(*own));
            lines.push(Line::new(name, shown.map(|(step, own)| (step as f64, *own))));
        }
        let name = format!("convergence-{scene}");
        Chart { x: "step", y: "difference from the end", lines: &lines, is_logarithmic: [false, true] }
            .draw(&recorder.plot(&name))?;
        plots.push(format!("\n![Convergence in {scene}]({}/{name}.svg)", record::FOLDER));
    }
    page.extend(plots);
    Ok(page.join("\n"))
}
