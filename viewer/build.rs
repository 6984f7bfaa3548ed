//! Copies the shaders without their comments and indentation, which a browser need not load.

use std::path::Path;
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=src/shaders");
    let out = env::var_os("OUT_DIR").ok_or(io::ErrorKind::NotFound)?;
    for entry in fs::read_dir("src/shaders")? {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "wgsl") {
            let source = fs::read_to_string(&path)?;
            let name = path.file_name().ok_or(io::ErrorKind::InvalidInput)?;
            fs::write(Path::new(&out).join(name), stripped(&source))?;
        }
    }
    Ok(())
}

/// Without line comments, indentation and empty lines.
fn stripped(source: &str) -> String {
    let code = |line: &str| line.split("//").next().unwrap_or_default().trim().to_owned();
    source.lines().map(code).filter(|line| !line.is_empty()).map(|line| line + "\n").collect()
}
