//! `rebounce compare`: how far a picture is from its reference.

use super::TOO_NOISY;
use super::picture::{check_panel, write_panel};
use anyhow::{Context, Result, bail};
use clap::Args;
use rebounce::io::picture::exr;
use rebounce::verify::compare::spots::{Spots, spots};
use rebounce::verify::compare::uncertainty::{Answer, shown};
use rebounce::verify::compare::{Comparison, compare, noticed, signed_difference};
use rebounce_args::number;
use std::path::PathBuf;
use std::process::ExitCode;

const AFTER_HELP: &str = "\
Two references of the same view whose noise differs tell how sure the error is: what is printed in brackets holds the truth about \
nineteen times in twenty. Where their noise hides the error, it is \"too noisy to tell\", and only the most that it can be is printed. \
Of one reference the error has the noise in it, and is too large.

Exit codes: 0 done, and within --max-error; 1 failed, or the error is above --max-error; 2 wrong arguments; 4 the references are too \
noisy to tell whether it is above --max-error: take both with more samples a pixel (rebounce reference --spp).

--json prints one object: error (null where it is too noisy to tell), error_at_least and error_at_most (null with one reference), bias, p95, flip, and with --spots \
spots: deviation and greatest of each rectangle.";

/// Arguments of `rebounce compare`.
#[derive(Args, Debug)]
#[command(after_help = AFTER_HELP)]
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
    /// Measures spots in a rectangle of the picture where a bare surface is
    ///
    /// Light on a bare wall is smooth: what is there at the size of spots is error. In thousandths of a stop, standard deviation and
    /// 99.5th percentile of the size; 15 (1%) begins to be seen. Sides are shares of the picture, as in 0.1,0.2,0.5,0.6; the option
    /// may be given several times.
    #[arg(long, value_name = "LEFT,TOP,RIGHT,BOTTOM", value_parser = number::rectangle)]
    spots: Vec<[f64; 4]>,
    /// Prints JSON
    #[arg(long)]
    json: bool,
    /// Fails above this error, and where the references are too noisy to tell whether it is above
    #[arg(long, value_parser = number::at_least_zero)]
    max_error: Option<f64>,
}

/// Output of `--json`.
#[derive(serde::Serialize)]
struct Printed {
    #[serde(flatten)]
    found: Comparison,
    flip: f64,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    spots: Vec<Spots>,
}

/// Gain of the difference picture.
const GAIN: f32 = 4.0;
/// Decimals of errors.
const DECIMALS: usize = 4;

/// Runs the command.
pub fn run(args: &CompareArgs) -> Result<ExitCode> {
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
    let spots: Vec<Spots> = args.spots.iter().map(|rectangle| spots(&picture, *rectangle)).collect();
    let flip = noticed(&picture, &reference);
    if args.json {
        println!("{}", serde_json::to_string(&Printed { found, flip, spots })?);
    } else {
        let noise = if args.second.is_none() { ", the reference's noise in it" } else { "" };
        let Comparison { error, bias, p95 } = &found;
        println!("{}{noise}  bias {bias:+.4}  p95 {p95:.4}  flip {flip:.4}", error.said(DECIMALS));
        for Spots { deviation, greatest } in spots {
            println!("spots {deviation:.1}, greatest {greatest:.0}, in thousandths of a stop");
        }
    }
    let Some(most) = args.max_error else { return Ok(ExitCode::SUCCESS) };
    match found.error.is_within(most) {
        Answer::Within => Ok(ExitCode::SUCCESS),
        Answer::Over if args.second.is_none() => bail!(
            "the error {} is above {most}; the reference's noise is in it, which a second reference takes out",
            shown(found.error.figure(), DECIMALS)
        ),
        Answer::Over => bail!("the error {} is above {most}", shown(found.error.figure(), DECIMALS)),
        Answer::TooNoisy => {
            eprintln!(
                "rebounce: the references are too noisy to tell whether the error is above {most}: {}; take both with more samples a pixel (--spp)",
                found.error.said(DECIMALS)
            );
            Ok(ExitCode::from(TOO_NOISY))
        }
    }
}
