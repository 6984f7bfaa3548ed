//! The generator of wasm-bindgen, as a library of the version linked by the viewer.

use anyhow::{Context, Result};
use std::collections::HashMap;
use std::path::Path;
use wasm_bindgen_cli_support::Bindgen;

/// Formatting of values in panic messages, and a shorter replacement: the bundler then drops the unused function.
const DEBUG: [&str; 2] = ["debugString(arg", "String(arg"];
/// Start of the script's own loading functions, and the replacement.
const LOAD: &str = "async function __wbg_load(";
/// Loads the viewer from a response.
pub const FROM_RESPONSE: &str = include_str!("init.js");
/// Loads the baker from a compiled module.
pub const FROM_MODULE: &str = include_str!("init-baker.js");

/// Writes `NAME.js`, `NAME.d.ts` and `NAME_bg.wasm` for a page that loads them as ES modules, through the function `init`.
///
/// # Errors
/// If the file is no wasm of this version of wasm-bindgen, or `out` cannot be written.
pub fn module(wasm: &Path, name: &str, init: &str, out: &Path) -> Result<()> {
    let mut generator = Bindgen::new();
    generator.web(true)?.typescript(true).remove_name_section(true).remove_producers_section(true);
    let file = || format!("making the JavaScript for {}", wasm.display());
    let mut output = generator.input_path(wasm).out_name(name).generate_output().with_context(file)?;
    let mut script = output.js().to_owned();
    // Hundreds of import names contain a hash, in both files: a sixteenth of a bundle after gzip.
    let mut short = HashMap::new();
    for (i, import) in output.wasm_mut().imports.iter_mut().enumerate() {
        short.insert(std::mem::replace(&mut import.name, format!("i{i}")), i);
    }
    // Export names of closures contain a hash, too.
    let is_long = |name: &str| name.starts_with("wasm_bindgen_");
    for (i, export) in output.wasm_mut().exports.iter_mut().filter(|export| is_long(&export.name)).enumerate()
    {
        let long = std::mem::replace(&mut export.name, format!("e{i}"));
        // Arguments or the end of the line follow a name; a longer name may have the same prefix.
        for end in ["(", ")", ",", ";"] {
            script = script.replace(&format!("wasm.{long}{end}"), &format!("wasm.e{i}{end}"));
        }
    }
    script = script
        .lines()
        .map(|line| match line.trim_start().split_once(':') {
            Some((long, rest)) if short.contains_key(long) => format!("i{}:{rest}\n", short[long]),
            _ => format!("{line}\n"),
        })
        .collect();
    let load = script.find(LOAD);
    script.truncate(load.with_context(|| {
        format!("what wasm-bindgen writes has no {LOAD:?} any more: see xtask/src/bindgen.rs")
    })?);
    script = script.replace(DEBUG[0], DEBUG[1]) + init;
    output.emit(out).with_context(file)?;
    let file = out.join(name).with_extension("js");
    std::fs::write(&file, script).with_context(|| file.display().to_string())
}

/// Writes the same files for a test program with tests as plain exports.
///
/// # Errors
/// As [`module`].
pub fn tests(wasm: &Path, name: &str, out: &Path) -> Result<()> {
    let mut generator = Bindgen::new();
    generator.web(true)?.typescript(false).debug(true).export_wasm(true).emit_start(false);
    generate(&mut generator, wasm, name, out)
}

fn generate(generator: &mut Bindgen, wasm: &Path, name: &str, out: &Path) -> Result<()> {
    std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
    generator
        .input_path(wasm)
        .out_name(name)
        .generate(out)
        .with_context(|| format!("making the JavaScript for {}", wasm.display()))
}
