//! `cargo xtask package`: the npm package as `npm publish` would send it, in target/package.

use crate::{process, web};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Files of the repository copied unchanged into the package.
const COPIED: [&str; 6] = [
    "web/package.json",
    "web/README.md",
    "web/react.d.ts",
    "web/LICENSE-OTHERS",
    "LICENSE-MIT",
    "LICENSE-APACHE",
];

/// Builds web/dist and packs it.
///
/// # Errors
/// If a tool is missing or fails.
pub fn run() -> Result<()> {
    web::build()?;
    println!("packed {}", pack()?.display());
    Ok(())
}

/// Packs web/dist (must exist) with the remaining files of the package; returns the path of the tarball.
///
/// # Errors
/// If a file is missing, or npm fails.
pub fn pack() -> Result<PathBuf> {
    let out = process::target().join("package");
    if out.exists() {
        fs::remove_dir_all(&out).with_context(|| out.display().to_string())?;
    }
    let stage = out.join("rebounce-viewer");
    let dist = stage.join("dist");
    for file in COPIED {
        copy(&process::root().join(file), &stage)?;
    }
    let built = process::root().join("web/dist");
    for name in web::names(&built)?.iter().filter(|name| belongs(name)) {
        process::copy(&built.join(name), &dist.join(name))?;
    }
    process::run(web::node().arg("manifest.mjs").arg(stage.join("custom-elements.json")))?;
    let npm = ["pack", "--ignore-scripts", "--loglevel=error", "--pack-destination"];
    process::run(Command::new("npm").args(npm).arg(&out).current_dir(&stage))?;
    fs::read_dir(&out)?
        .flatten()
        .map(|entry| entry.path())
        .find(|path| path.extension().is_some_and(|extension| extension == "tgz"))
        .context("npm pack has left no .tgz file")
}

/// Whether a file of web/dist is part of the package; the page of `rebounce view` is not.
fn belongs(name: &str) -> bool {
    let is_part = [".js", ".d.ts", ".wasm", ".json"].iter().any(|end| name.ends_with(end));
    is_part && !name.starts_with("page.") && !name.starts_with("page/")
}

/// Copies a file into a folder.
fn copy(file: &Path, folder: &Path) -> Result<()> {
    process::copy(file, &folder.join(file.file_name().unwrap_or_default()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_rebounce_view_stays_out() {
        for name in ["rebounce-viewer.js", "wire/shot.d.ts", "rebounce_viewer_bg.wasm", "integrity.json"] {
            assert!(belongs(name), "{name}");
        }
        for name in ["page.js", "page/watch.d.ts", "page.css", "index.html"] {
            assert!(!belongs(name), "{name}");
        }
    }
}
