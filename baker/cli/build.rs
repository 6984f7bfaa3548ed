//! Puts the built viewer (the folder `viewer`, made by `cargo xtask web`) into the binary, for `rebounce view`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let manifest = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let viewer = manifest.join("viewer");
    println!("cargo::rerun-if-changed=build.rs");
    // A path that is not there makes Cargo build again every time; the folder's own folder is there.
    println!("cargo::rerun-if-changed={}", if viewer.is_dir() { "viewer" } else { "." });
    let names = served(&viewer)?;
    if names.is_empty() {
        println!(
            "cargo::warning=the viewer is not built, so `rebounce view` will not work: run `cargo xtask web` first"
        );
    }
    let mut list = String::from("&[\n");
    for name in names {
        let copy = out.join("web").join(&name);
        if let Some(parent) = copy.parent() {
            fs::create_dir_all(parent)?;
        }
        fs::copy(viewer.join(&name), &copy)?;
        // The list is written only to a String, which cannot fail.
        let _ = writeln!(list, "({name:?}, include_bytes!({copy:?})),");
    }
    list.push(']');
    fs::write(out.join("web_files.rs"), list)
}

/// The files that a browser asks for, sorted.
fn served(viewer: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    if viewer.is_dir() {
        for entry in fs::read_dir(viewer)? {
            names.push(entry?.file_name().to_string_lossy().into_owned());
        }
    }
    names.sort();
    Ok(names)
}
