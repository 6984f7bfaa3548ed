//! The command `rebounce`. Subcommands, one per file: read arguments, call the library and print.

mod bake;
mod communicator;
mod compare;
mod draft;
mod export;
mod http;
mod info;
mod load;
mod picture;
mod progress;
mod reference;
mod render;
mod solve;
mod stop;
mod view;

use anyhow::{Context, Result};
use clap::{ArgAction, Parser, Subcommand};
use rebounce_args::escape::escape_controls;
use rebounce_shared::baked::BakedScene;
use std::path::Path;
use std::process::ExitCode;

/// Exit code if noise hides whether an error is small enough.
const TOO_NOISY: u8 = 4;

/// Bakes how light bounces through a glTF scene, so that it can be relit live in a browser.
#[derive(Parser, Debug)]
#[command(name = "rebounce", version, disable_version_flag = true, propagate_version = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Prints the version
    #[arg(short = 'v', short_alias = 'V', long, action = ArgAction::Version, global = true, display_order = 999)]
    version: (),
}

#[derive(Subcommand, Debug)]
enum Command {
    /// Bakes a scene into a .rbn file
    Bake(Box<rebounce_args::bake::BakeArgs>),
    /// Solves for lights that stay in place, into a small .rbn file
    Solve(Box<solve::SolveArgs>),
    /// Says what is inside a .rbn file, and whether it is whole
    Info(info::InfoArgs),
    /// Takes a picture of a baked scene on the CPU
    Render(render::RenderArgs),
    /// Takes a picture of a scene with a brute-force path tracer, to compare with
    Reference(Box<reference::ReferenceArgs>),
    /// Says how far a picture is from its reference
    Compare(compare::CompareArgs),
    /// Writes a .glb file with the light in a texture or in vertex colours, for other engines
    Export(export::ExportArgs),
    /// Shows a scene in the browser, from this machine
    View(view::ViewArgs),
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(code) => code,
        Err(error) => {
            eprintln!("rebounce: {}", escape_controls(&sentence(&error)));
            ExitCode::FAILURE
        }
    }
}

/// The error and its causes as a sentence.
fn sentence(error: &anyhow::Error) -> String {
    rebounce_args::error::sentence(error.chain())
}

/// Runs the subcommand and returns the exit code.
fn run(arguments: &Arguments) -> Result<ExitCode> {
    match &arguments.command {
        Command::Bake(args) => return bake::run(args),
        Command::Solve(args) => solve::run(args),
        Command::Info(args) => info::run(args),
        Command::Render(args) => render::run(args),
        Command::Reference(args) => reference::run(args),
        Command::Compare(args) => return compare::run(args),
        Command::Export(args) => export::run(args),
        Command::View(args) => return view::run(args),
    }?;
    Ok(ExitCode::SUCCESS)
}

/// Reads a baked file; returns the bytes and the parsed scene.
fn read_baked(path: &Path) -> Result<(Vec<u8>, BakedScene)> {
    let name = || path.display().to_string();
    let bytes = std::fs::read(path).with_context(|| format!("cannot read {}", name()))?;
    let scene = BakedScene::from_bytes(&bytes).with_context(name)?;
    Ok((bytes, scene))
}
