//! Tests of the baker, in one program: a program per test file would link the library repeatedly.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[cfg(feature = "antiradiance")]
mod antiradiance;
mod box_room;
mod common {
    pub mod boxes;
    pub mod crowd;
    pub mod quads;
    pub mod soup;
    pub mod split;
}

mod closed_forms;
mod communicator;
mod copies;
mod diffuse_transfer;
mod door;
mod exact_enclosures;
mod examples;
mod export;
mod first_view;
mod furnace;
mod gloss;
mod gloss_links;
mod gltf;
mod ground;
mod groups;
mod join;
mod laws;
mod leaks;
#[cfg(feature = "exact-faces")]
mod lightmap;
mod materials;
mod open;
mod pairwise;
mod points;
mod reflections;
mod resume;
mod simplify;
mod size;
mod solve;
mod sources;
mod spots;
mod step;
mod tiles;
