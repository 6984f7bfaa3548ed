//! The options of `rebounce bake`: one table for the command and for the npm package, which bakes without it.
//!
//! Parsing, help and their errors are clap's. Files are read from a [`Files`](rebounce::io::Files), so that everything
//! here runs in WebAssembly, too.
//!
//! * [`bake`] – the arguments of `rebounce bake`, and their settings; [`plan`] – the settings within the budget;
//! * [`layout`], [`load`], [`sky`] – groups of arguments, which other subcommands have as well;
//! * [`number`] – parsers of numbers; [`paths`] – checks of inputs and outputs; [`table`] – the options as data, for
//!   callers that are programs;
//! * [`progress`], [`escape`], [`error`] – what is printed.

pub mod bake;
pub mod error;
pub mod escape;
pub mod layout;
pub mod load;
pub mod number;
pub mod paths;
pub mod plan;
pub mod progress;
pub mod sky;
pub mod table;
