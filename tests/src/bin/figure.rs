//! Writes the walking figure: `cargo run -p rebounce-tests --bin figure FIGURE.glb`.

use anyhow::{Context, Result};
use rebounce::demo::walker::glb;

fn main() -> Result<()> {
    let path = std::env::args_os().nth(1).context("give the file to write, as in figure.glb")?;
    std::fs::write(&path, glb()).with_context(|| path.to_string_lossy().into_owned())
}
