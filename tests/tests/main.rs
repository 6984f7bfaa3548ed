//! Tests that span crates, in one program: separate programs would each link every crate.

mod common;
#[path = "../../baker/tests/common/crowd.rs"]
#[allow(dead_code, reason = "not all of it is used here")]
mod crowd;
#[path = "common/panel.rs"]
mod panel;

mod area;
mod backs;
mod blended;
mod compare;
mod copies;
mod cracks;
mod diffuse_transfer;
mod direct;
mod display;
mod environment;
mod exposure;
mod figure;
mod gloss;
mod kinds;
mod moving;
mod openness;
mod penumbra;
mod shadows;
mod shown;
mod solved;
mod turning;
