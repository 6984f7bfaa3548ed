//! The npm package of the command: `rebounce-cli`, with the baker as WebAssembly, and a package of the native program for
//! each platform, as npm's optionalDependencies have it.

use crate::{bindgen, install, process, toolchain, web};
use anyhow::{Context, Result};
use serde::Deserialize;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Version of the packages.
const VERSION: &str = env!("CARGO_PKG_VERSION");
/// Declarations of types that users of the package see.
const TYPES: [&str; 5] = ["index.d.ts", "options.d.ts", "types.d.ts", "version.d.ts", "vite.d.ts"];
/// Files of the repository copied unchanged into the package.
const COPIED: [&str; 6] = [
    "baker/npm/package.json",
    "baker/npm/README.md",
    "baker/npm/client.d.ts",
    "web/LICENSE-OTHERS",
    "LICENSE-MIT",
    "LICENSE-APACHE",
];

/// A platform with a package of its own: an entry of `baker/npm/platforms.json`.
#[derive(Deserialize)]
struct Platform {
    /// Name as Node.js has it: `process.platform` and `process.arch`.
    name: String,
    /// The compiler's target.
    target: String,
    os: String,
    cpu: String,
    libc: Option<String>,
    /// File name of the program.
    program: String,
}

/// Builds baker/npm/dist: the modules of the package.
///
/// # Errors
/// If a tool is missing or fails.
pub fn build(purpose: web::Purpose) -> Result<()> {
    install::ensure(&install::NODE)?;
    web::npm()?;
    let npm = process::root().join("baker/npm");
    let (pkg, dist) = (npm.join("pkg"), npm.join("dist"));
    let wasm =
        web::baker_wasm(toolchain::find()?, purpose.profile("npm"), &["--features", web::COMMAND_STEP])?;
    bindgen::module(&wasm, web::BAKER, bindgen::FROM_MODULE, &pkg)?;
    let node = |args: &[&Path]| process::run(Command::new("node").args(args).current_dir(&npm));
    node(&[Path::new("generate.mjs"), &pkg, &npm.join("src/options.ts")])?;
    let modules = pkg.join("modules");
    for folder in [&modules, &dist] {
        if folder.exists() {
            fs::remove_dir_all(folder).with_context(|| folder.display().to_string())?;
        }
    }
    node(&[Path::new("../../web/node_modules/typescript/bin/tsc")])?;
    node(&[Path::new("bundle.mjs"), &modules, &dist, Path::new(VERSION)])?;
    for name in [format!("{}.js", web::BAKER), format!("{}_bg.wasm", web::BAKER)] {
        process::copy(&pkg.join(&name), &dist.join(&name))?;
    }
    for name in TYPES {
        process::copy(&modules.join("baker/npm/src").join(name), &dist.join(name))?;
    }
    println!("built {}", dist.display());
    Ok(())
}

/// Packs baker/npm/dist (must exist); returns the tarball.
///
/// # Errors
/// If a file is missing, or npm fails.
pub fn pack(out: &Path) -> Result<PathBuf> {
    let stage = out.join("rebounce-cli");
    for file in COPIED {
        let file = process::root().join(file);
        process::copy(&file, &stage.join(file.file_name().unwrap_or_default()))?;
    }
    let dist = process::root().join("baker/npm/dist");
    for name in web::names(&dist)? {
        process::copy(&dist.join(&name), &stage.join("dist").join(&name))?;
    }
    packed(&stage, out)
}

/// Packs a native program for this machine; returns the tarball, or `None` if this machine has no package.
///
/// # Errors
/// If a file is missing, or npm fails.
pub fn pack_native(program: &Path, out: &Path) -> Result<Option<PathBuf>> {
    let list = process::root().join("baker/npm/platforms.json");
    let list = fs::read_to_string(&list).with_context(|| list.display().to_string())?;
    let platforms: Vec<Platform> = serde_json::from_str(&list).context("baker/npm/platforms.json")?;
    let is_this = |platform: &Platform| {
        platform.target.starts_with(std::env::consts::ARCH) && platform.target.contains(std::env::consts::OS)
    };
    let Some(platform) = platforms.into_iter().find(is_this) else { return Ok(None) };
    let name = format!("rebounce-cli-{}", platform.name);
    let stage = out.join(&name);
    process::copy(program, &stage.join("bin").join(&platform.program))?;
    for file in ["LICENSE-MIT", "LICENSE-APACHE", "web/LICENSE-OTHERS"] {
        let file = process::root().join(file);
        process::copy(&file, &stage.join(file.file_name().unwrap_or_default()))?;
    }
    let mut package = serde_json::json!({
        "name": name,
        "version": VERSION,
        "description": format!("The native program of rebounce-cli for {}.", platform.name),
        "license": "MIT OR Apache-2.0",
        "repository": { "type": "git", "url": "git+https://github.com/rebounce/rebounce.git", "directory": "baker/cli" },
        "os": [platform.os],
        "cpu": [platform.cpu],
        "files": ["bin", "LICENSE-*"],
        "preferUnplugged": true,
    });
    if let Some(libc) = platform.libc {
        package["libc"] = serde_json::json!([libc]);
    }
    let file = stage.join("package.json");
    fs::write(&file, serde_json::to_vec_pretty(&package)?).with_context(|| file.display().to_string())?;
    packed(&stage, out).map(Some)
}

/// Packs a folder with npm; returns the tarball.
///
/// # Errors
/// If npm fails.
pub fn packed(stage: &Path, out: &Path) -> Result<PathBuf> {
    let npm = ["pack", "--ignore-scripts", "--loglevel=error", "--pack-destination"];
    process::run(Command::new("npm").args(npm).arg(out).current_dir(stage))?;
    let name = stage.file_name().unwrap_or_default().to_string_lossy();
    let tarball = out.join(format!("{name}-{VERSION}.tgz"));
    anyhow::ensure!(tarball.is_file(), "npm pack has left no {}", tarball.display());
    Ok(tarball)
}
