//! Minifies the shaders, for a smaller download.

mod minify;

use std::path::{Path, PathBuf};
use std::{env, fs, io};

fn main() -> io::Result<()> {
    println!("cargo::rerun-if-changed=src/shaders");
    println!("cargo::rerun-if-changed=minify.rs");
    let out = env::var_os("OUT_DIR").ok_or(io::ErrorKind::NotFound)?;
    let mut paths = shaders("src/shaders")?;
    let own = paths.len();
    // What other programs need does not change the bytes of the element.
    paths.extend(shaders("src/shaders/three")?);
    paths.extend(shaders("src/shaders/radiosity")?);
    paths.extend(shaders("src/shaders/antiradiance")?);
    let sources = paths.iter().map(fs::read_to_string).collect::<io::Result<Vec<_>>>()?;
    for (path, short) in paths.iter().zip(minify::minified(&sources, own)) {
        fs::write(Path::new(&out).join(path.file_name().ok_or(io::ErrorKind::InvalidInput)?), short)?;
    }
    Ok(())
}

fn shaders(folder: &str) -> io::Result<Vec<PathBuf>> {
    let mut paths: Vec<_> =
        fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<_>>()?;
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "wgsl"));
    paths.sort();
    Ok(paths)
}
