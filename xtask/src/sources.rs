//! The Rust sources of the crates, parsed: what `cargo xtask layers` and `cargo xtask names` read.

use crate::process;
use anyhow::{Context, Result};
use std::path::{Path, PathBuf};

/// The checked crates.
pub const CRATES: [&str; 8] =
    ["shared", "baker", "baker/args", "baker/cad", "baker/cli", "baker/wasm", "viewer", "viewer/three"];

/// The reader of STEP files: a feature, since its parser takes minutes to compile. Checks and tests have it.
pub const STEP: &str = "rebounce-cad/step";

/// The source folder of a crate.
pub fn of(name: &str) -> PathBuf {
    process::root().join(name).join("src")
}

/// The Rust files under a folder, parsed, without those of tests.
///
/// # Errors
/// If a file cannot be read or parsed.
pub fn parsed(folder: &Path) -> Result<Vec<(PathBuf, syn::File)>> {
    let mut files = Vec::new();
    list(folder, &mut files)?;
    let parse = |file: PathBuf| {
        let text = std::fs::read_to_string(&file).with_context(|| file.display().to_string())?;
        let parsed = syn::parse_file(&text).with_context(|| file.display().to_string())?;
        Ok((file, parsed))
    };
    files.into_iter().map(parse).collect()
}

/// The Rust files of all checked crates, without those of tests.
///
/// # Errors
/// If a folder cannot be read.
pub fn all_files() -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for name in CRATES {
        list(&of(name), &mut files)?;
    }
    Ok(files)
}

/// Lists the Rust files under a folder, without tests.
fn list(folder: &Path, files: &mut Vec<PathBuf>) -> Result<()> {
    let entries = std::fs::read_dir(folder).with_context(|| folder.display().to_string())?;
    let mut paths: Vec<PathBuf> = entries.map(|entry| Ok(entry?.path())).collect::<Result<_>>()?;
    paths.sort();
    for path in paths {
        let stem = path.file_stem().and_then(|stem| stem.to_str());
        if stem == Some("tests") {
            continue;
        }
        if path.is_dir() {
            list(&path, files)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    Ok(())
}

/// Whether code is compiled for tests only.
pub fn is_test(attributes: &[syn::Attribute]) -> bool {
    let says_test = |list: &syn::MetaList| list.path.is_ident("cfg") && list.tokens.to_string() == "test";
    attributes.iter().any(|attribute| matches!(&attribute.meta, syn::Meta::List(list) if says_test(list)))
}
