//! `cargo xtask site`: the site of web/site with its scenes and pictures, in target/site. Scenes and
//! pictures are made anew only when the program that makes them is newer than they are.

use crate::process::{self, copy};
use crate::web;
use anyhow::{Context, Result, bail};
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// What the command line asks for.
#[derive(Debug, PartialEq)]
struct Options {
    quality: Quality,
    serve: bool,
    port: Option<u16>,
}

/// How good scenes and pictures are.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// Preset of the bakes.
    preset: String,
    /// More arguments of the bakes.
    bake: Vec<String>,
    /// Width and height of the pictures, pixels.
    size: [u32; 2],
    /// Samples a pixel of each of the two path-traced pictures.
    samples: u32,
}

impl Quality {
    /// To look at: some minutes on two cores.
    fn usual() -> Self {
        Self { preset: "draft".into(), bake: Vec::new(), size: [768, 432], samples: 32 }
    }

    /// To test with: seconds.
    pub fn quick() -> Self {
        let bake = vec!["--functions".into(), "4000".into()];
        Self { preset: "draft".into(), bake, size: [160, 90], samples: 4 }
    }

    /// Part of file names: files of another quality are other files.
    fn key(&self) -> String {
        let [width, height] = self.size;
        format!("{}{}-{width}x{height}-{}", self.preset, self.bake.concat(), self.samples)
    }
}

/// The built-in scenes that the pages show.
const SCENES: [&str; 3] = ["cornell-box", "apartment", "library"];
/// The scene of the comparison.
const COMPARED: &str = "library";

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

/// Builds everything, and serves it if asked to.
///
/// # Errors
/// If a step fails.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    web::build()?;
    let program = ["build", "--locked", "--release", "--package", "rebounce", "--bin", "rebounce"];
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

/// Puts the site into a folder, with the scenes and pictures that this `rebounce` makes. web/dist is
/// there.
///
/// # Errors
/// If a file cannot be read or written, or a bake or a picture fails.
pub fn build(rebounce: &Path, quality: &Quality, out: &Path) -> Result<()> {
    let maker = Maker {
        rebounce: rebounce.to_owned(),
        work: process::target().join("site-work").join(quality.key()),
        quality: quality.clone(),
    };
    fs::create_dir_all(&maker.work).with_context(|| maker.work.display().to_string())?;
    let mut files = Vec::new();
    for name in SCENES {
        let baked = maker.baked(name)?;
        files.push((format!("images/{name}.png"), maker.picture(name, &baked)?));
        files.push((format!("scenes/{name}.rbn"), baked));
    }
    let (ours, error) = maker.panel("rebounce", "all")?;
    let (direct, _) = maker.panel("direct", "direct")?;
    files.push(("images/compare-rebounce.png".into(), ours));
    files.push(("images/compare-direct.png".into(), direct));
    let values = BTreeMap::from([
        ("samples", (2 * quality.samples).to_string()),
        ("preset", quality.preset.clone()),
        ("error", format!("{error:.3}")),
    ]);

    if out.exists() {
        fs::remove_dir_all(out).with_context(|| out.display().to_string())?;
    }
    for (name, file) in files {
        copy(&file, &out.join(name))?;
    }
    let site = process::root().join("web/site");
    let layout = read(&site.join("layout.html"))?;
    for file in entries(&site)? {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        match name.strip_suffix(".html") {
            Some("layout") => {}
            Some(_) => {
                let text = page(&layout, &name, &read(&file)?, &values).with_context(|| name.clone())?;
                fs::write(out.join(&name), text).with_context(|| name.clone())?;
            }
            None => copy(&file, &out.join(name))?,
        }
    }
    for file in entries(&process::root().join("web/dist"))? {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if (name.ends_with(".js") || name.ends_with(".wasm")) && name != "page.js" {
            copy(&file, &out.join("rebounce-viewer").join(name))?;
        }
    }
    Ok(())
}

/// Puts a page into the layout. It begins with lines `<!-- NAME: VALUE -->`: title, description and,
/// where it has any, scripts. `{{NAME}}` in the page stands for a value.
fn page(layout: &str, name: &str, text: &str, values: &BTreeMap<&str, String>) -> Result<String> {
    let mut head: BTreeMap<&str, &str> = BTreeMap::new();
    let mut rest = text;
    while let Some((line, after)) = rest.split_once('\n') {
        let Some(comment) = line.strip_prefix("<!-- ").and_then(|line| line.strip_suffix(" -->")) else {
            break;
        };
        let (key, value) = comment.split_once(": ").context("a head line needs a name and a value")?;
        head.insert(key, value);
        rest = after;
    }
    let get = |key: &str| head.get(key).with_context(|| format!("the page has no {key}"));
    let scripts: String = head
        .get("scripts")
        .into_iter()
        .flat_map(|list| list.split_whitespace())
        .map(|script| format!("    <script type=\"module\" src=\"{script}\"></script>\n"))
        .collect();
    let link = format!("<li><a href=\"{name}\"");
    let mut whole = layout
        .replace(&link, &format!("{link} aria-current=\"page\""))
        .replace("{{title}}", get("title")?)
        .replace("{{description}}", get("description")?)
        .replace("{{scripts}}\n", &scripts)
        .replace("{{main}}", rest.trim_end());
    for (key, value) in values {
        whole = whole.replace(&format!("{{{{{key}}}}}"), value);
    }
    if whole.contains("{{") {
        bail!("something between {{{{ and }}}} has no value");
    }
    Ok(whole)
}

/// Makes scenes and pictures where they are not yet there.
struct Maker {
    rebounce: PathBuf,
    work: PathBuf,
    quality: Quality,
}

impl Maker {
    fn baked(&self, name: &str) -> Result<PathBuf> {
        self.made(&format!("{name}.rbn"), |command| {
            command.args(["bake", &format!("builtin:{name}"), "--preset", &self.quality.preset]);
            command.args(&self.quality.bake);
        })
    }

    /// The scene's first camera and its lights.
    fn picture(&self, name: &str, baked: &Path) -> Result<PathBuf> {
        self.made(&format!("{name}.png"), |command| {
            command.arg("render").arg(baked).args(["--size", &self.size()]);
        })
    }

    /// Path-traced picture, ours or part of ours, and their difference, side by side; how far ours is off.
    fn panel(&self, name: &str, only: &str) -> Result<(PathBuf, f64)> {
        let truth = |seed: &str| {
            self.made(&format!("truth-{seed}.exr"), |command| {
                command.args(["reference", &format!("builtin:{COMPARED}"), "--size", &self.size()]);
                command.args(["--seed", seed, "--spp", &self.quality.samples.to_string()]);
            })
        };
        let (first, second) = (truth("1")?, truth("2")?);
        let baked = self.baked(COMPARED)?;
        let picture = self.made(&format!("{name}.exr"), |command| {
            command.arg("render").arg(&baked).args(["--size", &self.size(), "--only", only]);
        })?;
        let panel = self.work.join(format!("{name}.panel.png"));
        let mut compare = Command::new(&self.rebounce);
        compare.arg("compare").args([&picture, &first, &second]).arg("--json").arg("--panel").arg(&panel);
        let line = process::line(&compare);
        let json = process::quiet(&mut compare).with_context(|| format!("`{line}` failed"))?;
        let found: serde_json::Value = serde_json::from_str(&json).context("rebounce compare")?;
        Ok((panel, found["error"].as_f64().context("rebounce compare gave no error")?))
    }

    fn size(&self) -> String {
        let [width, height] = self.quality.size;
        format!("{width}x{height}")
    }

    /// A file of the work folder; `rebounce` makes it with these arguments and `-o` where it is older than
    /// the program.
    fn made(&self, name: &str, arguments: impl Fn(&mut Command)) -> Result<PathBuf> {
        let file = self.work.join(name);
        let time = |path: &Path| fs::metadata(path).and_then(|data| data.modified()).ok();
        if time(&file).is_none_or(|made| time(&self.rebounce).is_none_or(|built| made < built)) {
            let mut command = Command::new(&self.rebounce);
            arguments(&mut command);
            process::run(command.arg("-o").arg(&file))?;
        }
        Ok(file)
    }
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

    #[test]
    fn pages_are_put_into_the_layout() {
        let layout =
            "<title>{{title}}</title>{{description}}\n{{scripts}}\n<li><a href=\"a.html\">A</a>\n{{main}}\n";
        let text = "<!-- title: A -->\n<!-- description: b -->\n<!-- scripts: a.js -->\n<p>{{n}}</p>\n";
        let whole = page(layout, "a.html", text, &BTreeMap::from([("n", "7".to_owned())])).unwrap();
        let expected = "<title>A</title>b\n    <script type=\"module\" src=\"a.js\"></script>\n\
                        <li><a href=\"a.html\" aria-current=\"page\">A</a>\n<p>7</p>\n";
        assert_eq!(whole, expected);
        assert!(page(layout, "a.html", "<!-- title: A -->\n<p></p>", &BTreeMap::new()).is_err());
        assert!(page(layout, "a.html", text, &BTreeMap::new()).is_err());
    }
}
