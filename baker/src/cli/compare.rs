//! `rebounce compare`: how far a picture is from its reference.

use super::number;
use super::picture::{check_panel, write_panel};
use anyhow::{Context, Result, bail};
use clap::Args;
use rebounce::picture::compare::{compare, signed_difference};
use rebounce::picture::exr;
use std::path::PathBuf;

/// Arguments of `rebounce compare`.
#[derive(Args, Debug)]
pub struct CompareArgs {
    /// The picture
    #[arg(value_name = "PICTURE.exr")]
    picture: PathBuf,
    /// What it should be
    #[arg(value_name = "REFERENCE.exr")]
    reference: PathBuf,
    /// The same with noise of its own (another --seed): the noise of both cancels out of the error
    #[arg(value_name = "SECOND.exr")]
    second: Option<PathBuf>,
    /// Writes the signed difference: red is too bright, blue too dark, four times the reference's RMS
    #[arg(long, value_name = "OUT.png")]
    difference: Option<PathBuf>,
    /// Writes reference, picture and difference side by side
    #[arg(long, value_name = "OUT.png")]
    panel: Option<PathBuf>,
    /// Prints JSON
    #[arg(long)]
    json: bool,
    /// Fails above this error
    #[arg(long, value_parser = number::at_least_zero)]
    max_error: Option<f64>,
}

/// Times that a difference is enlarged in pictures.
const GAIN: f32 = 4.0;

/// Runs the command.
pub fn run(args: &CompareArgs) -> Result<()> {
    for out in [&args.difference, &args.panel].into_iter().flatten() {
        check_panel(out)?;
    }
    let (picture, reference) = (exr::read(&args.picture)?, exr::read(&args.reference)?);
    let second = args.second.as_deref().map(exr::read).transpose()?;
    let found = compare(&picture, &reference, second.as_ref())
        .with_context(|| format!("{} and {}", args.picture.display(), args.reference.display()))?;
    let reference = second.as_ref().map_or(reference.clone(), |second| reference.mean(second));
    let difference = signed_difference(&picture, &reference, GAIN);
    if let Some(out) = &args.difference {
        write_panel(out, None, &[&difference])?;
    }
    if let Some(out) = &args.panel {
        write_panel(out, Some(&[&reference, &picture]), &[&difference])?;
    }
    if args.json {
        println!("{}", serde_json::to_string(&found)?);
    } else {
        println!("error {:.4}  bias {:+.4}  p95 {:.4}", found.error, found.bias, found.p95);
    }
    match args.max_error {
        Some(most) if found.error > most => bail!("the error {:.4} is above {most}", found.error),
        _ => Ok(()),
    }
}
