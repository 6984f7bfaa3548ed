//! `compare PICTURE REFERENCE`: prints how far one picture of linear radiance is from another, as JSON.
//! Each is an .exr, or RGBA floats in a file named NAME-WIDTHxHEIGHT.f32.

use anyhow::{Result, bail};
use rebounce::picture::compare::compare;
use rebounce_tests::float_picture::read;
use std::path::PathBuf;

fn main() -> Result<()> {
    let files: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [picture, reference] = files.as_slice() else { bail!("usage: compare PICTURE REFERENCE") };
    println!("{}", serde_json::to_string(&compare(&read(picture)?, &read(reference)?, None)?)?);
    Ok(())
}
