//! Sources of the standard library of wasm32-unknown-unknown.
//!
//! First choice: the target of the active toolchain. Otherwise Debian's packaged toolchain for web browsers
//! (rustc-web, includes the library's sources) builds the library.

use crate::install::{self, Need};
use crate::process;
use anyhow::{Result, bail};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// The target's name.
pub const TARGET: &str = "wasm32-unknown-unknown";
const DEBIAN_CARGO: &str = "/usr/bin/cargo";
const DEBIAN_RUSTC: &str = "/usr/bin/rustc";

/// A Cargo that can build for wasm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Toolchain {
    /// The active toolchain has the target.
    Ordinary,
    /// Debian's toolchain builds the standard library from source.
    Debian,
}

/// Finds a toolchain for wasm, and installs a missing toolchain. Later calls return the one that the first has found.
///
/// # Errors
/// If no toolchain is found or installable.
pub fn find() -> Result<Toolchain> {
    static FOUND: Mutex<Option<Toolchain>> = Mutex::new(None);
    let mut found = FOUND.lock().unwrap_or_else(PoisonError::into_inner);
    let toolchain = found.map_or_else(look, Ok)?;
    *found = Some(toolchain);
    Ok(toolchain)
}

fn look() -> Result<Toolchain> {
    if has_target() {
        return Ok(Toolchain::Ordinary);
    }
    if process::find(&["rustup"]).is_some() {
        println!("installing Rust's standard library for {TARGET} (rustup target add)");
        if add_target() && has_target() {
            return Ok(Toolchain::Ordinary);
        }
        println!("  that failed; building it with Debian's rustc-web instead");
    }
    install::ensure(&DEBIAN)?;
    if !Path::new(DEBIAN_CARGO).is_file() || !has_sources() {
        bail!("no way to compile for {TARGET} was found; install it with `rustup target add {TARGET}`");
    }
    Ok(Toolchain::Debian)
}

const DEBIAN: [Need; 5] = [
    Need {
        package: "rustc-web",
        why: "compiles the viewer to WebAssembly",
        present: || exists(DEBIAN_RUSTC),
    },
    Need { package: "cargo-web", why: "the Cargo of that compiler", present: || exists(DEBIAN_CARGO) },
    Need {
        package: "rust-web-src",
        why: "the standard library's sources, built for WebAssembly",
        present: has_sources,
    },
    Need {
        package: "rust-web-llvm",
        why: "code generation for WebAssembly",
        present: || exists("/usr/bin/rust-lld"),
    },
    Need { package: "lld-22", why: "links WebAssembly", present: || exists("/usr/bin/lld-22") },
];

fn exists(file: &str) -> bool {
    Path::new(file).exists()
}

fn has_sources() -> bool {
    let sysroot =
        process::quiet(Command::new(DEBIAN_RUSTC).args(["--print", "sysroot"]).env_remove("LD_LIBRARY_PATH"));
    sysroot.is_some_and(|dir| {
        Path::new(dir.trim()).join("lib/rustlib/src/rust/library/std/Cargo.toml").is_file()
    })
}

/// Whether the active compiler has the target's standard library.
fn has_target() -> bool {
    let Some(dir) = process::quiet(
        Command::new("rustc")
            .args(["--print", "target-libdir", "--target", TARGET])
            .current_dir(process::root()),
    ) else {
        return false;
    };
    let Ok(entries) = std::fs::read_dir(dir.trim()) else { return false };
    entries.flatten().any(|entry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        name.starts_with("libstd-") && name.ends_with(".rlib")
    })
}

/// Tries to add the target once, without output, with a time limit.
fn add_target() -> bool {
    let started = Command::new("rustup")
        .args(["target", "add", TARGET])
        .env("RUSTUP_MAX_RETRIES", "1")
        .current_dir(process::root())
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    let Ok(child) = started else { return false };
    let mut child = process::Running(child);
    let until = Instant::now() + Duration::from_secs(180);
    while Instant::now() < until {
        match child.0.try_wait() {
            Ok(Some(status)) => return status.success(),
            Ok(None) => std::thread::sleep(Duration::from_millis(100)),
            Err(_) => return false,
        }
    }
    false
}

impl Toolchain {
    /// `cargo VERB --target wasm32-unknown-unknown`, to be completed.
    pub fn cargo(self, verb: &str) -> Command {
        let mut command = match self {
            Toolchain::Ordinary => process::cargo(),
            Toolchain::Debian => Command::new(DEBIAN_CARGO),
        };
        command.current_dir(process::root()).arg(verb).args(["--target", TARGET]);
        // Flags of the native build do not apply to wasm.
        command.env_remove("RUSTFLAGS").env_remove("CARGO_ENCODED_RUSTFLAGS");
        if self == Toolchain::Ordinary {
            command.arg("--locked");
        } else {
            command.arg("-Zbuild-std=std,panic_abort");
            // Variables set by rustup's proxies would mix two compilers.
            for name in ["RUSTUP_TOOLCHAIN", "LD_LIBRARY_PATH", "CARGO", "RUSTDOC", "RUSTC_WRAPPER"] {
                command.env_remove(name);
            }
            command
                .env("RUSTC", DEBIAN_RUSTC)
                .env("RUSTC_BOOTSTRAP", "1")
                .env("CARGO_TARGET_WASM32_UNKNOWN_UNKNOWN_LINKER", "rust-lld")
                .env("CARGO_TARGET_DIR", self.target());
        }
        command
    }

    /// Build directory: two compilers need separate directories.
    pub fn target(self) -> std::path::PathBuf {
        match self {
            Toolchain::Ordinary => process::target(),
            Toolchain::Debian => process::target().join("wasm"),
        }
    }
}
