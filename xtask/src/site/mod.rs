//! `cargo xtask site`: the site of web/site with its scenes, pictures and figures, in target/site. Scenes and
//! pictures are rebuilt only when older than their inputs.
//!
//! * `maker` – scenes and pictures; `figures` – their costs; `page` – the pages.

mod figures;
mod maker;
mod page;

use crate::process::{self, copy};
use crate::{install, web};
use anyhow::{Context, Result, bail};
use maker::Maker;
use page::{Values, page};
use std::fs;
use std::path::{Path, PathBuf};

/// Command line options.
#[derive(Debug, PartialEq)]
struct Options {
    quality: Quality,
    serve: bool,
    port: Option<u16>,
}

/// Quality of scenes and pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// Preset of the bakes.
    preset: String,
    /// Additional arguments of the bakes.
    bake: Vec<String>,
    /// Width and height of the pictures, pixels.
    size: [u32; 2],
    /// Samples per pixel of each of the two path-traced pictures.
    samples: u32,
}

impl Quality {
    /// For viewing: a few minutes on two cores.
    fn usual() -> Self {
        Self { preset: "draft".into(), bake: Vec::new(), size: [768, 432], samples: 32 }
    }

    /// For tests: seconds.
    pub fn quick() -> Self {
        let bake = vec!["--functions".into(), "4000".into()];
        Self { preset: "draft".into(), bake, size: [160, 90], samples: 4 }
    }

    /// Key in file names, different for every quality.
    fn key(&self) -> String {
        let [width, height] = self.size;
        format!("{}{}-{width}x{height}-{}", self.preset, self.bake.concat(), self.samples)
    }
}

/// Placeholder picture of a viewer until its scene is loaded: `images/NAME.png`.
pub struct View {
    name: &'static str,
    /// The built-in scene.
    scene: &'static str,
    /// Whether camera and lights come from `shots/NAME.json`; otherwise from the scene.
    has_shot: bool,
    /// Whether the pages tell the time of a frame.
    is_timed: bool,
    /// Width over height.
    shape: [u32; 2],
}

/// Built-in scenes shown on the pages.
const SCENES: [&str; 4] = ["cornell-box", "apartment", "library", "gallery"];
/// The apartment with somebody in it.
const WALK: &str = "walk";
/// Views of the viewers on the pages.
const VIEWS: [View; 8] = [
    View { name: "hero", scene: "apartment", has_shot: true, is_timed: false, shape: [1, 1] },
    View { name: "apartment", scene: "apartment", has_shot: false, is_timed: false, shape: [16, 9] },
    View { name: "library", scene: "library", has_shot: false, is_timed: false, shape: [16, 9] },
    View { name: WALK, scene: WALK, has_shot: true, is_timed: false, shape: [16, 9] },
    View { name: "evening", scene: "apartment", has_shot: true, is_timed: true, shape: [4, 3] },
    View { name: "reading", scene: "library", has_shot: true, is_timed: true, shape: [4, 3] },
    View { name: "hall", scene: "gallery", has_shot: true, is_timed: true, shape: [4, 3] },
    View { name: "blocks", scene: "cornell-box", has_shot: true, is_timed: true, shape: [4, 3] },
];

/// What the bundle for three.js fetches from its own folder.
const THREE_WASM: &str = "rebounce_three_bg.wasm";
/// The one of [`SAMPLES`] that three.js shows, baked.
const IN_THREE: &str = "rotunda";

/// Scenes that visitors may bake themselves: `samples/NAME.glb`, with a picture `images/sample-NAME.png`.
const SAMPLES: [&str; 4] = ["red-and-green", "afternoon", "courtyard", "rotunda"];

fn parse(args: &[String]) -> Result<Options> {
    let mut options = Options { quality: Quality::usual(), serve: false, port: None };
    let mut args = args.iter();
    while let Some(name) = args.next() {
        let mut value = || args.next().with_context(|| format!("{name} needs a value"));
        match name.as_str() {
            "--quick" => options.quality = Quality::quick(),
            "--preset" => options.quality.preset = value()?.clone(),
            "--samples" => {
                options.quality.samples = value()?.parse().context("--samples needs a number from 1")?;
            }
            "--serve" => options.serve = true,
            "--port" => options.port = Some(value()?.parse().context("--port needs a number up to 65535")?),
            other => bail!(
                "there is no option {other}; there are --quick, --preset, --samples, --serve and --port"
            ),
        }
    }
    Ok(options)
}

/// Builds the site, and serves it on request.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    // The browser measures frame times.
    install::ensure(&install::BROWSER)?;
    web::build(web::Purpose::Publish)?;
    let program = ["build", "--locked", "--release", "--package", "rebounce-cli", "--bin", "rebounce"];
    process::run(process::cargo().args(program))?;
    let out = process::target().join("site");
    build(&process::target().join("release/rebounce"), &options.quality, &out)?;
    println!("built {}", out.display());
    if options.serve {
        let port = options.port.unwrap_or(7778).to_string();
        process::run(web::node().arg("test/serve.mjs").arg(&out).arg(port))?;
    }
    Ok(())
}

/// Builds the site in a folder, with scenes and pictures by the program `rebounce`. Requires web/dist.
///
/// # Errors
/// If a file cannot be read or written, or a bake or a picture fails.
pub fn build(rebounce: &Path, quality: &Quality, out: &Path) -> Result<()> {
    let maker = Maker::new(rebounce, quality)?;
    let site = process::root().join("web/site");
    let mut files = Vec::new();
    let mut values = Values::new();
    for name in SCENES {
        let (baked, report) = maker.baked(name)?;
        values.extend(figures::of_bake(name, &report)?);
        files.push((format!("scenes/{name}.rbn"), baked));
    }
    files.push((format!("scenes/{WALK}.rbn"), maker.baked(WALK)?.0));
    for view in &VIEWS {
        let shot = view.has_shot.then(|| site.join(format!("shots/{}.json", view.name)));
        files.push((format!("images/{}.png", view.name), maker.picture(view, shot.as_deref())?));
        files.extend(shot.map(|shot| (format!("shots/{}.json", view.name), shot)));
    }
    let samples = maker.samples()?;
    for name in SAMPLES {
        files.push((format!("images/sample-{name}.png"), maker.sample_picture(&samples, name)?));
        files.push((format!("samples/{name}.glb"), samples.join(format!("{name}.glb"))));
    }
    files.push((format!("scenes/{IN_THREE}.rbn"), maker.baked_sample(&samples, IN_THREE)?));
    let (ours, error) = maker.panel("rebounce", "all")?;
    let (direct, _) = maker.panel("direct", "direct")?;
    files.push(("images/compare-rebounce.png".into(), ours));
    files.push(("images/compare-direct.png".into(), direct));
    let told = [
        ("samples", (2 * quality.samples).to_string()),
        ("preset", quality.preset.clone()),
        ("error", format!("{error:.3}")),
    ];
    values.extend(told.map(|(name, value)| (name.to_owned(), value)));

    if out.exists() {
        fs::remove_dir_all(out).with_context(|| out.display().to_string())?;
    }
    for (name, file) in files {
        copy(&file, &out.join(name))?;
    }
    for file in entries(&process::root().join("web/dist"))? {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if web::is_code(&name) {
            copy(&file, &out.join("rebounce-viewer").join(name))?;
        }
    }
    let three = out.join("three");
    process::run(web::node().arg("site/three/bundle.mjs").arg(&three))?;
    copy(&process::root().join("web/dist").join(THREE_WASM), &three.join(THREE_WASM))?;
    values.insert("three-hall".into(), escaped(&read(&site.join("three/hall.js"))?));
    values.extend(figures::of_frames(out, quality.size)?);
    write_pages(&site, out, &values)
}

/// Writes the pages, and copies the files of their folder.
fn write_pages(site: &Path, out: &Path, values: &Values) -> Result<()> {
    let layout = read(&site.join("layout.html"))?;
    for file in entries(site)? {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match name.strip_suffix(".html") {
            Some("layout") => {}
            Some(_) => {
                let text = page(&layout, &name, &read(&file)?, values).with_context(|| name.clone())?;
                fs::write(out.join(&name), text).with_context(|| name.clone())?;
            }
            None => copy(&file, &out.join(name))?,
        }
    }
    Ok(())
}

/// A text as it stands in HTML.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").trim_end().to_owned()
}

fn read(file: &Path) -> Result<String> {
    fs::read_to_string(file).with_context(|| file.display().to_string())
}

/// The files of a folder, sorted.
fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut files: Vec<PathBuf> =
        entries.flatten().map(|entry| entry.path()).filter(|p| p.is_file()).collect();
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let options = parse(&words("--preset fine --samples 9 --serve --port 81")).unwrap();
        assert_eq!((options.quality.preset.as_str(), options.quality.samples), ("fine", 9));
        assert_eq!((options.serve, options.port), (true, Some(81)));
        assert_eq!(parse(&words("--quick")).unwrap().quality, Quality::quick());
        for line in ["--preset", "--samples many", "--port 70000", "somewhere"] {
            assert!(parse(&words(line)).is_err(), "{line}");
        }
    }
}
