//! The baker as WebAssembly: one worker of a bake, for web pages and Node.js.
//!
//! A bake runs in workers of one thread each, without shared memory. Each worker has the whole scene; they share the
//! gathers and send each other the results (`workers`). The messages go through the page, which is
//! `web/src/bake/bake.ts`.
//!
//! * `options` – what a page may ask for; `worker` – a bake; `workers` – the other members; `observer` – progress and
//!   previews.
#![cfg(target_arch = "wasm32")]

mod observer;
mod options;
mod worker;
mod workers;

pub use worker::{BakedFile, Host, SceneFiles, bake};
