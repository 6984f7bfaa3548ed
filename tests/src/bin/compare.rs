//! `compare PICTURE REFERENCE [REFERENCE]`: prints the difference between two pictures of linear radiance, as JSON.
//! Two references with independent noise cancel the noise. Files are .exr, or RGBA floats in a file named
//! NAME-WIDTHxHEIGHT.f32.

use anyhow::{Result, bail};
use rebounce::verify::compare::compare;
use rebounce_tests::float_picture::read;
use std::path::PathBuf;

fn main() -> Result<()> {
    let files: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let (picture, reference, second) = match files.as_slice() {
        [picture, reference] => (picture, reference, None),
        [picture, reference, second] => (picture, reference, Some(read(second)?)),
        _ => bail!("usage: compare PICTURE REFERENCE [REFERENCE]"),
    };
    println!("{}", serde_json::to_string(&compare(&read(picture)?, &read(reference)?, second.as_ref())?)?);
    Ok(())
}
