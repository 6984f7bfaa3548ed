//! The command `rebounce`.

mod cli;

use clap::Parser;
use cli::escape::escape_controls;
use std::process::ExitCode;

fn main() -> ExitCode {
    match cli::run(&cli::Arguments::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("rebounce: {}", escape_controls(&sentence(&error)));
            ExitCode::FAILURE
        }
    }
}

/// Joins the error and its causes; skips causes already contained in the text of earlier errors.
fn sentence(error: &anyhow::Error) -> String {
    error.chain().fold(String::new(), |said, cause| {
        let cause = cause.to_string();
        match () {
            () if said.is_empty() => cause,
            () if said.contains(&cause) => said,
            () => format!("{said}: {cause}"),
        }
    })
}
