//! Puts the built viewer (web/dist) into the binary, for `rebounce view`, and names the sources that it is made of:
//! what one build kept of a bake, another does not go on with.

use std::fmt::Write as _;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    let manifest = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").unwrap_or_default());
    let out = PathBuf::from(env::var_os("OUT_DIR").unwrap_or_default());
    let web = manifest.join("../web");
    let dist = web.join("dist");
    println!("cargo::rerun-if-changed=build.rs");
    // A path that is not there would make Cargo build again every time.
    match (dist.is_dir(), web.is_dir()) {
        (true, _) => println!("cargo::rerun-if-changed=../web/dist"),
        (_, true) => println!("cargo::rerun-if-changed=../web"),
        _ => {}
    }
    println!("cargo::rustc-env=REBOUNCE_SOURCES={}", sources(&manifest)?);
    let names = served(&dist)?;
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
        fs::copy(dist.join(&name), &copy)?;
        // The list is written only to a String, which cannot fail.
        let _ = writeln!(list, "({name:?}, include_bytes!({copy:?})),");
    }
    list.push(']');
    fs::write(out.join("web_files.rs"), list)
}

/// The files that a browser asks for, sorted.
fn served(dist: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    if dist.is_dir() {
        for entry in fs::read_dir(dist)? {
            let name = entry?.file_name().to_string_lossy().into_owned();
            if !name.ends_with(".d.ts") {
                names.push(name);
            }
        }
    }
    names.sort();
    Ok(names)
}

/// A name for the contents of what bakes: the crate's sources, those that it shares, and the versions of all crates.
fn sources(manifest: &Path) -> io::Result<String> {
    let mut files = Vec::new();
    for root in ["src", "../shared/src", "../Cargo.lock"].map(|name| manifest.join(name)) {
        if root.exists() {
            println!("cargo::rerun-if-changed={}", root.display());
            collect(&root, &mut files)?;
        }
    }
    files.sort();
    let mut hasher = DefaultHasher::new();
    for file in files {
        fs::read(file)?.hash(&mut hasher);
    }
    Ok(format!("{:016x}", hasher.finish()))
}

fn collect(path: &Path, files: &mut Vec<PathBuf>) -> io::Result<()> {
    if path.is_dir() {
        for entry in fs::read_dir(path)? {
            collect(&entry?.path(), files)?;
        }
    } else {
        files.push(path.to_path_buf());
    }
    Ok(())
}
