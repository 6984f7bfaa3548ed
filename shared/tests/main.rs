//! Tests of the shared crate, in one program.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

#[cfg(feature = "radiosity")]
mod cube_maps;
#[cfg(feature = "radiosity")]
mod diffuse_transfer;
#[cfg(feature = "radiosity")]
mod gloss;
#[cfg(feature = "radiosity")]
mod gloss_links;
#[cfg(feature = "radiosity")]
mod lightmap;
mod openness;
#[cfg(feature = "radiosity")]
mod rig;
mod rules;
mod shown;
#[cfg(feature = "radiosity")]
mod specular;
mod versions;
