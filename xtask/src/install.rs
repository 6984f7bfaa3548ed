//! External dependencies of the commands: missing packages are installed and reported.

use crate::process;
use anyhow::{Result, bail};
use std::path::Path;
use std::process::Command;

/// Debian package with a test of its presence.
#[derive(Clone, Copy)]
pub struct Need {
    /// Package name.
    pub package: &'static str,
    /// Purpose.
    pub why: &'static str,
    /// Whether the package's contents are present, from any source.
    pub present: fn() -> bool,
}

/// Node.js and npm, for building the page.
pub const NODE: [Need; 2] = [
    Need { package: "nodejs", why: "builds the page and drives the browser in tests", present: has_node },
    Need {
        package: "npm",
        why: "fetches the TypeScript compiler and Playwright's driver",
        present: || process::find(&["npm"]).is_some(),
    },
];

/// Minimum major version of Node.js for Playwright's driver.
const OLDEST_NODE: u32 = 18;

fn has_node() -> bool {
    let Some(node) = process::find(&["node", "nodejs"]) else { return false };
    let version = process::quiet(Command::new(node).arg("--version")).unwrap_or_default();
    let major = version.trim().trim_start_matches('v').split('.').next().and_then(|major| major.parse().ok());
    major.is_some_and(|major: u32| major >= OLDEST_NODE)
}

/// Browser with WebGPU, with a software implementation for machines without a GPU.
pub const BROWSER: [Need; 3] = [
    Need {
        package: "chromium",
        why: "the browser that tests and screenshots run in",
        present: || chromium().is_some(),
    },
    Need {
        package: "mesa-vulkan-drivers",
        why: "Vulkan in software (lavapipe) for tests without a GPU",
        present: || lavapipe().is_some(),
    },
    Need { package: "libvulkan1", why: "the Vulkan loader", present: has_vulkan_loader },
];

/// Encoder of animated WebP files.
pub const FILM: [Need; 1] = [Need {
    package: "webp",
    why: "makes an animated picture out of frames (img2webp)",
    present: || process::find(&["img2webp"]).is_some(),
}];

/// Open MPI, for bakes over several processes, with the packages for building against Open MPI.
pub const MPI: [Need; 3] = [
    Need {
        package: "openmpi-bin",
        why: "starts the processes of one bake (mpirun)",
        present: || process::find(&["mpirun"]).is_some(),
    },
    Need {
        package: "libopenmpi-dev",
        why: "the MPI that the feature mpi is built against",
        present: || process::find(&["mpicc"]).is_some(),
    },
    Need { package: "libclang-dev", why: "reads MPI's C headers for the build", present: has_libclang },
];

fn has_libclang() -> bool {
    let below = |dir: &str| std::fs::read_dir(dir).into_iter().flatten().flatten().map(|entry| entry.path());
    let versions = below("/usr/lib").filter(|path| path.to_string_lossy().contains("llvm"));
    let dirs = versions.map(|path| path.join("lib")).chain(["/usr/lib", "/usr/lib64"].map(Into::into));
    std::env::var_os("LIBCLANG_PATH").is_some()
        || dirs
            .into_iter()
            .any(|dir| ["libclang.so", "libclang.so.1"].iter().any(|name| dir.join(name).exists()))
}

/// Path of the browser; the environment variable CHROMIUM overrides the search.
pub fn chromium() -> Option<std::path::PathBuf> {
    match std::env::var_os("CHROMIUM") {
        Some(file) => Some(file.into()),
        None => process::find(&["chromium", "chromium-browser", "google-chrome"]),
    }
}

/// Path of the ICD description of Mesa's software Vulkan.
pub fn lavapipe() -> Option<std::path::PathBuf> {
    let entries = std::fs::read_dir("/usr/share/vulkan/icd.d").ok()?;
    entries
        .flatten()
        .map(|entry| entry.path())
        .find(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with("lvp_icd")))
}

fn has_vulkan_loader() -> bool {
    let dirs = [
        "/usr/lib",
        "/usr/lib64",
        "/lib",
        "/usr/local/lib",
        "/usr/lib/x86_64-linux-gnu",
        "/usr/lib/aarch64-linux-gnu",
    ];
    dirs.iter().any(|dir| Path::new(dir).join("libvulkan.so.1").exists())
}

/// `cargo xtask install`: installs the dependencies of every command.
///
/// # Errors
/// If a dependency is missing and cannot be installed.
pub fn all() -> Result<()> {
    ensure(&NODE)?;
    ensure(&BROWSER)?;
    crate::toolchain::find()?;
    crate::web::npm()?;
    println!("everything needed is installed");
    Ok(())
}

/// Installs missing packages through apt.
///
/// # Errors
/// Without apt, with the list of missing packages and instructions; or if apt fails.
pub fn ensure(needs: &[Need]) -> Result<()> {
    let missing: Vec<&Need> = needs.iter().filter(|need| !(need.present)()).collect();
    if missing.is_empty() {
        return Ok(());
    }
    let list: String = missing.iter().map(|need| format!("\n  {:20} {}", need.package, need.why)).collect();
    if process::find(&["apt-get"]).is_none() {
        bail!(
            "these are needed and not found (names of Debian packages):{list}\ninstall them with this system's package manager, and run the command again"
        );
    }
    println!("installing through apt:{list}");
    let is_root = process::quiet(Command::new("id").arg("-u")).is_some_and(|id| id.trim() == "0");
    if !is_root && process::find(&["sudo"]).is_none() {
        let names: Vec<&str> = missing.iter().map(|need| need.package).collect();
        bail!("installing needs root and there is no sudo; run as root: apt-get install {}", names.join(" "));
    }
    let apt = || {
        let mut command = Command::new(if is_root { "apt-get" } else { "sudo" });
        if !is_root {
            command.args(["env", "DEBIAN_FRONTEND=noninteractive", "apt-get"]);
        }
        command.env("DEBIAN_FRONTEND", "noninteractive");
        command
    };
    update(apt().args(["update", "-qq"]))?;
    process::run(
        apt()
            .args(["install", "-y", "-qq", "--no-install-recommends"])
            .args(missing.iter().map(|need| need.package)),
    )?;
    if let Some(need) = missing.iter().find(|need| !(need.present)()) {
        bail!(
            "apt has installed {}, but what is needed of it is still not there, or too old (Node.js has to be \
             {OLDEST_NODE} or newer); install a newer one and run the command again",
            need.package
        );
    }
    Ok(())
}

/// Refreshes apt's lists, once in a run.
fn update(command: &mut Command) -> Result<()> {
    static ONCE: std::sync::Once = std::sync::Once::new();
    let mut result = Ok(());
    ONCE.call_once(|| result = process::run(command));
    result
}
