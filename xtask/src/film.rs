//! `cargo xtask film`: an animated WebP of a lamp that moves through a scene, for the README.

use crate::{demo, install, process, web};
use anyhow::{Context, Result, bail};
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Limit of the file, bytes.
const LIMIT: u64 = 3_000_000;
/// Time of a frame, milliseconds: 15 frames a second.
const FRAME_MS: u32 = 67;
/// Qualities of lossy WebP, best first; the first within the limit is used.
const QUALITIES: [u32; 6] = [92, 86, 80, 70, 55, 40];

/// Command line options.
#[derive(Debug, PartialEq)]
struct Options {
    scene: String,
    out: PathBuf,
}

fn parse(args: &[String]) -> Result<Options> {
    let out = process::root().join("docs/relight.webp");
    let mut options = Options { scene: "builtin:apartment".to_owned(), out };
    let mut args = args.iter();
    while let Some(name) = args.next() {
        let mut value = || args.next().with_context(|| format!("{name} needs a value"));
        match name.as_str() {
            "--scene" => options.scene = value()?.clone(),
            "--out" => options.out = std::path::absolute(value()?)?,
            other => bail!("there is no option {other}; there are --scene and --out"),
        }
    }
    Ok(options)
}

/// Builds the programs, bakes the scene, takes the frames and encodes them.
///
/// # Errors
/// If a step fails, a frame is blank, or the file is over its limit at any quality.
pub fn run(args: &[String]) -> Result<()> {
    let options = parse(args)?;
    install::ensure(&install::BROWSER)?;
    install::ensure(&install::FILM)?;
    let rebounce = demo::build()?;
    let baked = demo::bake(&rebounce, &options.scene, "standard", "film")?;
    let folder = process::target().join("film/frames");
    clear(&folder)?;
    let server =
        demo::serve(Command::new(&rebounce).arg("view").arg(&baked).args(["--no-open", "--port", "0"]))?;
    process::run(web::node().arg("test/film.mjs").arg(&server.address).arg(&folder))?;
    encode(&folder, &options.out)
}

/// Makes an empty folder.
fn clear(folder: &Path) -> Result<()> {
    if folder.exists() {
        fs::remove_dir_all(folder).with_context(|| folder.display().to_string())?;
    }
    fs::create_dir_all(folder).with_context(|| folder.display().to_string())
}

/// Names of a folder's files, in order.
fn names(folder: &Path) -> Result<Vec<OsString>> {
    let entries = fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut names = entries.map(|entry| Ok(entry?.file_name())).collect::<Result<Vec<_>>>()?;
    names.sort();
    Ok(names)
}

/// Writes a folder's frames as an animated WebP that loops forever, at the best quality within the limit.
fn encode(folder: &Path, out: &Path) -> Result<()> {
    let frames = names(folder)?;
    for quality in QUALITIES {
        let mut command = Command::new("img2webp");
        // Key frames alone: other frames keep blocks of earlier ones that are alike, and colours would lag.
        command.args(["-loop", "0", "-kmin", "0", "-kmax", "1"]);
        command.args(["-lossy", "-m", "6", "-q", &quality.to_string(), "-d", &FRAME_MS.to_string()]);
        command.args(&frames).arg("-o").arg(out).current_dir(folder);
        process::run(&mut command)?;
        let bytes = fs::metadata(out).with_context(|| out.display().to_string())?.len();
        if bytes <= LIMIT {
            println!("wrote {}: {} frames, quality {quality}, {bytes} bytes", out.display(), frames.len());
            return Ok(());
        }
    }
    bail!("{} has more than {LIMIT} bytes at any quality; take fewer or smaller frames", out.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn options() {
        let words = |line: &str| line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let options = parse(&words("--scene a/room.glb --out /b/out.webp")).unwrap();
        assert_eq!(options, Options { scene: "a/room.glb".to_owned(), out: "/b/out.webp".into() });
        let options = parse(&[]).unwrap();
        assert_eq!(options.scene, "builtin:apartment");
        assert!(options.out.ends_with("docs/relight.webp"));
        for line in ["--scene", "--out", "--what", "room.glb"] {
            assert!(parse(&words(line)).is_err(), "{line}");
        }
    }
}
