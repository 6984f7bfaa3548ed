//! Tests of the renderer, in one program: as many programs would each link all of it.
#![cfg(not(target_arch = "wasm32"))]

mod common;

mod blended;
mod detail;
mod glass;
mod openness;
mod picture;
mod relight;
mod scope;
mod smooth;
mod splat;
mod still;
