//! The command `rebounce`. Each verb is a module of [`cli`].

mod cli;

use clap::{Parser, Subcommand};

/// Bakes how light bounces through a scene, so that it can be relit live in a browser.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Subcommand)]
enum Verb {
    /// Bakes a glTF scene into a .rbn file
    Bake(cli::bake::BakeArgs),
}

fn main() -> anyhow::Result<()> {
    match Arguments::parse().verb {
        Verb::Bake(arguments) => cli::bake::run(&arguments),
    }
}
