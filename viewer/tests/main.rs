//! Tests of the renderer in one program, to link the renderer only once.
#![cfg(not(target_arch = "wasm32"))]

mod common;

#[cfg(feature = "antiradiance")]
mod antiradiance;
#[cfg(feature = "antiradiance")]
mod antiradiance_scene;
mod area;
mod blended;
mod cached_direct;
mod detail;
mod glass;
mod openness;
mod picture;
mod probes;
#[cfg(feature = "radiosity")]
mod radiosity;
mod relight;
#[cfg(feature = "radiosity")]
mod rig;
mod scope;
mod smooth;
mod splat;
