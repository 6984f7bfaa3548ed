//! `cargo xtask demo`: from a fresh checkout to a lit room in the browser.

use crate::{install, process, web};
use anyhow::{Context, Result, bail};
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{ChildStdout, Command, Stdio};

/// Command line options.
#[derive(Debug, Default, PartialEq)]
struct Options {
    scene: Option<String>,
    port: Option<u16>,
    screenshot: Option<PathBuf>,
}

fn parse(args: &[String]) -> Result<Options> {
    let mut options = Options::default();
    let mut args = args.iter();
    while let Some(name) = args.next() {
        let mut value = || args.next().with_context(|| format!("{name} needs a value"));
        match name.as_str() {
            "--scene" => options.scene = Some(value()?.clone()),
            "--port" => options.port = Some(value()?.parse().context("--port needs a number up to 65535")?),
            "--screenshot" => options.screenshot = Some(value()?.into()),
            other => bail!("there is no option {other}; there are --scene, --port and --screenshot"),
        }
    }
    Ok(options)
}

/// Builds the programs, bakes the scene, and shows the scene, or takes a screenshot.
///
/// # Errors
/// If a step fails, or the picture is blank.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    if options.screenshot.is_some() {
        install::ensure(&install::BROWSER)?;
    }
    let rebounce = build()?;
    let scene = options.scene.as_deref().unwrap_or("builtin:cornell-box");
    let baked = bake(&rebounce, scene, "draft", "demo")?;
    let mut view = Command::new(&rebounce);
    view.arg("view").arg(&baked).arg("--no-open");
    match options.screenshot {
        Some(out) => {
            view.args(["--port", &options.port.unwrap_or(0).to_string()]);
            screenshot(&mut view, &std::path::absolute(out)?)
        }
        None => {
            if let Some(port) = options.port {
                view.args(["--port", &port.to_string()]);
            }
            process::run(&mut view)
        }
    }
}

/// Builds the viewer and the command; returns the command's path.
///
/// # Errors
/// If a build fails.
pub fn build() -> Result<PathBuf> {
    web::build(web::Purpose::Publish)?;
    process::run(process::cargo().args([
        "build",
        "--locked",
        "--release",
        "--package",
        "rebounce-cli",
        "--bin",
        "rebounce",
    ]))?;
    Ok(process::target().join("release/rebounce"))
}

/// Bakes a scene into a folder of Cargo's target directory; returns the file's path.
///
/// # Errors
/// If the bake fails.
pub fn bake(rebounce: &Path, scene: &str, preset: &str, folder: &str) -> Result<PathBuf> {
    let dir = process::target().join(folder);
    std::fs::create_dir_all(&dir).with_context(|| dir.display().to_string())?;
    let baked = dir.join(baked_name(scene));
    process::run(Command::new(rebounce).args(["bake", scene, "--preset", preset, "-o"]).arg(&baked))?;
    Ok(baked)
}

/// Name of the scene's baked file.
fn baked_name(scene: &str) -> String {
    let name = match scene.strip_prefix("builtin:") {
        Some(name) => name.to_owned(),
        None => Path::new(scene).file_stem().unwrap_or_default().to_string_lossy().into_owned(),
    };
    name + ".rbn"
}

/// Running `rebounce view`.
pub struct Server {
    /// Address of the page.
    pub address: String,
    _process: process::Running,
    // Kept open until the end: a server with closed output would fail on its next output.
    _output: BufReader<ChildStdout>,
}

/// Starts `rebounce view`; waits for its address.
///
/// # Errors
/// If the server cannot be started, or prints no address.
pub fn serve(view: &mut Command) -> Result<Server> {
    let child = view.stdout(Stdio::piped()).spawn().context("rebounce view could not be started")?;
    let mut process = process::Running(child);
    let stdout = process.0.stdout.take().context("rebounce view has no output")?;
    let mut output = BufReader::new(stdout);
    let mut line = String::new();
    output.read_line(&mut line).context("rebounce view")?;
    let address = line.split_whitespace().find(|word| word.starts_with("http://"));
    let address = address.context("rebounce view printed no address")?.to_owned();
    Ok(Server { address, _process: process, _output: output })
}

/// Starts the server, loads the page in headless Chromium, and writes a screenshot.
fn screenshot(view: &mut Command, out: &Path) -> Result<()> {
    let server = serve(view)?;
    println!("taking a picture of {}", server.address);
    process::run(web::node().arg("test/screenshot.mjs").arg(&server.address).arg(out))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let options = parse(&words("--scene a/room.glb --port 81 --screenshot out.png")).unwrap();
        assert_eq!(options.scene.as_deref(), Some("a/room.glb"));
        assert_eq!((options.port, options.screenshot), (Some(81), Some("out.png".into())));
        assert_eq!(parse(&[]).unwrap(), Options::default());
        for line in ["--scene", "--port x", "--port 70000", "--what", "room.glb"] {
            assert!(parse(&words(line)).is_err(), "{line}");
        }
    }

    #[test]
    fn baked_files_are_named_after_their_scene() {
        assert_eq!(baked_name("builtin:cornell-box"), "cornell-box.rbn");
        assert_eq!(baked_name("some/where/room.v2.glb"), "room.v2.rbn");
    }
}
