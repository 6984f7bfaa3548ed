//! `cargo xtask package`: the npm packages as `npm publish` would send them, in target/package.

use crate::{npm, process, web};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};

/// Files of the repository copied unchanged into the package.
const COPIED: [&str; 6] = [
    "web/package.json",
    "web/README.md",
    "web/react.d.ts",
    "web/LICENSE-OTHERS",
    "LICENSE-MIT",
    "LICENSE-APACHE",
];

/// The tarballs of the npm packages.
pub struct Tarballs {
    /// `rebounce-viewer`.
    pub viewer: PathBuf,
    /// `rebounce-cli`.
    pub command: PathBuf,
    /// The native program for this machine, if there is a package for it.
    pub native: Option<PathBuf>,
}

/// Builds the packages, with the native program in its release profile, and packs them.
///
/// # Errors
/// If a tool is missing or fails.
pub fn run() -> Result<()> {
    web::build(web::Purpose::Publish)?;
    npm::build(web::Purpose::Publish)?;
    let mut cargo = process::cargo();
    cargo.args(["build", "--locked", "--release", "--package", "rebounce-cli"]);
    // Half of the program is names of lines, which only its authors need.
    process::run(cargo.env("CARGO_PROFILE_RELEASE_STRIP", "debuginfo"))?;
    let Tarballs { viewer, command, native } = pack(&process::target().join("release/rebounce"))?;
    for tarball in [Some(viewer), Some(command), native].into_iter().flatten() {
        println!("packed {}", tarball.display());
    }
    Ok(())
}

/// Packs web/dist and baker/npm/dist (must exist) with the remaining files of the packages, and the native program
/// `rebounce`.
///
/// # Errors
/// If a file is missing, or npm fails.
pub fn pack(rebounce: &Path) -> Result<Tarballs> {
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
    Ok(Tarballs {
        viewer: npm::packed(&stage, &out)?,
        command: npm::pack(&out)?,
        native: npm::pack_native(rebounce, &out)?,
    })
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
