//! The baker as WebAssembly: one worker of a bake, for web pages and Node.js.
//!
//! A bake runs in workers of one thread each, without shared memory. Each worker has the whole scene; they share the
//! gathers and send each other the results (`workers`). The messages go through JavaScript, which is
//! `web/src/bake/bake.ts` in pages, and `baker/npm/src` in Node.js.
//!
//! * `host` – what JavaScript does for a worker; `workers` – the other members; `observer` – progress and previews;
//! * `worker` – a bake of a page, `options` – what a page may ask for;
//! * `command` (feature `command`) – the command `rebounce bake`; `host_files` – the files that it names.
#![cfg(target_arch = "wasm32")]

#[cfg(feature = "command")]
mod command;
mod host;
#[cfg(feature = "command")]
mod host_files;
mod observer;
mod options;
mod worker;
mod workers;

#[cfg(feature = "command")]
pub use command::{CommandFile, bake_command, options_table, parse};
pub use host::Host;
pub use worker::{BakedFile, SceneFiles, bake};
