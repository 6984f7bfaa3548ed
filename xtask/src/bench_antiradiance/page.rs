//! `cargo xtask bench-antiradiance --page`: antiradiance in a browser.

use crate::{install, process, report, web};
use anyhow::{Context, Result};
use serde::Deserialize;
use std::path::Path;
use std::process::Command;

/// Functions asked for in the office, all of one level: its points and the clusters above them are the paper's 18,200 elements.
const OFFICE_FUNCTIONS: &str = "9400";

/// Output of web/bench/figure.mjs.
#[derive(Debug, Deserialize)]
struct Figures {
    walk: Walk,
    office: Office,
}

/// Milliseconds of a frame.
#[derive(Debug, Deserialize)]
struct Walk {
    operator: f64,
    antiradiance: f64,
    stats: Stats,
}

#[derive(Debug, Deserialize)]
struct Office {
    /// Seconds until the links are there.
    linked: f64,
    /// Milliseconds of a step.
    step: f64,
    stats: Stats,
}

#[derive(Debug, Deserialize)]
struct Stats {
    adapter: String,
    antiradiance: Counts,
}

#[derive(Debug, Deserialize)]
struct Counts {
    elements: u64,
    links: u64,
    bins: u64,
}

/// Measures and writes docs/reports/antiradiance-page.md.
///
/// # Errors
/// If a step fails.
pub fn run() -> Result<()> {
    install::ensure(&install::BROWSER)?;
    web::build(web::Purpose::Publish)?;
    process::run(process::cargo().args(["build", "--locked", "--release", "--package", "rebounce-cli"]))?;
    let work = process::target().join("antiradiance");
    std::fs::create_dir_all(&work).with_context(|| work.display().to_string())?;
    let [walk, office, out] = ["walk.rbn", "office.rbn", "page.json"].map(|name| work.join(name));
    let bake = |args: &[&str], out: &Path| {
        let mut bake = Command::new(process::target().join("release/rebounce"));
        process::run(bake.arg("bake").args(args).arg("-o").arg(out))
    };
    // As the site has it.
    bake(
        &["builtin:apartment", "--add", "builtin:walker", "--at", "2.65,0,1.2", "--preset", "draft"],
        &walk,
    )?;
    bake(
        &["builtin:office", "--solver", "radiosity", "--levels", "1", "--functions", OFFICE_FUNCTIONS],
        &office,
    )?;
    let shot = process::root().join("web/site/shots/walk.json");
    process::run(web::node().arg("bench/figure.mjs").args([&walk, &shot, &office, &out]))?;
    let text = std::fs::read(&out).with_context(|| out.display().to_string())?;
    let figures: Figures = serde_json::from_slice(&text).with_context(|| out.display().to_string())?;
    let page = figures.page();
    println!("{page}");
    let command = "cargo xtask bench-antiradiance --page";
    report::write("antiradiance-page", "Antiradiance in the page", command, &page)
}

impl Figures {
    fn page(&self) -> String {
        let Self { walk, office, .. } = self;
        let [of_walk, of_office] = [&walk.stats.antiradiance, &office.stats.antiradiance];
        let mega = |bytes: u64| bytes as f64 / 1e6;
        // Incident and exitant, three half floats and a fourth.
        let tables = mega(16 * of_office.elements * of_office.bins);
        format!(
            "Medians in Chromium on {adapter}.\n\n\
             ## A figure that walks\n\n\
             The apartment, a draft, with the walking figure (`builtin:walker`), 1280 x 720: frames of a walk in\n\
             steps of 1/30 s, with the links of each pose and a slice of a step.\n\n\
             | bounced light by | a frame, s |\n|---|---|\n\
             | operator | {operator:.2} |\n\
             | operator and antiradiance | {both:.2} |\n\n\
             {elements} elements, {links} links, {bins} bins. Added cost: {added:.2} times the frame without.\n\n\
             ## The office at the paper's size\n\n\
             The paper's figures are those of its Table 2, on an NVIDIA GeForce 8800 of 2007: passes of four\n\
             iterations, global, local, push and pull. Ours are a sweep, with all of that in its waves.\n\n\
             | | elements | links | bins | linking, s | four steps, ms | tables, MB |\n|---|---|---|---|---|---|---|\n\
             | paper | 18200 | 632000 | 128 | 8.7 | 63.4 + 7.1 + 14.0 = 84.5 | 71.3 |\n\
             | here | {office_elements} | {office_links} | {office_bins} | {linked:.1} | {steps:.0} | {tables:.1} |",
            adapter = walk.stats.adapter,
            operator = walk.operator / 1e3,
            both = walk.antiradiance / 1e3,
            elements = of_walk.elements,
            links = of_walk.links,
            bins = of_walk.bins,
            added = walk.antiradiance / walk.operator - 1.0,
            office_elements = of_office.elements,
            office_links = of_office.links,
            office_bins = of_office.bins,
            linked = office.linked,
            steps = 4.0 * office.step,
        )
    }
}
