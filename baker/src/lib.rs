//! Bakes how light bounces through a scene, so that the scene can be relit live.
//!
//! [`bake`](bake::bake) precomputes light transport: a sparse operator from direct to bounced light, in a meshless
//! hierarchical basis (Lehtinen et al. 2008). The result is a [`BakedScene`](prelude::BakedScene), saved as a .rbn file;
//! `<rebounce-viewer>` shows it in a browser, and [`verify::render`](mod@verify::render) on the CPU.
//!
//! ```
//! use rebounce::prelude::*;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let folder = std::env::temp_dir().join("rebounce-doc");
//! # std::fs::create_dir_all(&folder)?;
//! # let output = folder.join("room.rbn");
//! let scene = load("builtin:cornell-box")?; // or "room.glb"
//! let mut settings = BakeSettings::new(Preset::Draft);
//! # settings.place.levels = 3;
//! settings.place.functions = 1_000; // the preset has more
//! let (baked, report) = bake(&scene, &settings, &())?;
//! println!("{report}");
//! save(&output, &baked)?;
//! # Ok(())
//! # }
//! ```
//!
//! Data flows one way: [`io`] and [`demo`] → [`scene`] → [`geometry`] → [`sampling`] → [`basis`] → [`transport`] → file.
//! [`bake`] runs the stages, as a [`job`] with progress, checkpoint and several processes; [`verify`] measures the result
//! against a path tracer; [`export`](mod@export) makes .glb files for engines without us.
//!
//! * A kind of surface is an implementation of [`Surfaces`](geometry::Surfaces): `examples/implicit.rs`.
//! * A way to compute light transport is an implementation of [`Solver`](transport::Solver): `examples/one_bounce.rs`.
//! * `examples/bake_and_save.rs` bakes in a build script, `examples/relight.rs` moves a lamp on the CPU.
//!
//! # Features
//!
//! * `gltf` (default): loads glTF 2.0;
//! * `demo-scenes` (default): generated scenes, as `builtin:apartment`;
//! * `export` (default): exports light as a texture or vertex colours of a .glb file;
//! * `mpi`: bakes over several processes.
//!
//! Without default features the crate builds for wasm32-unknown-unknown.

pub mod bake;
pub mod basis;
#[cfg(feature = "demo-scenes")]
pub mod demo;
#[cfg(feature = "export")]
pub mod export;
pub mod geometry;
pub mod io;
pub mod job;
mod lanes;
pub mod light;
mod morton;
pub mod prelude;
mod processor;
pub mod sampling;
pub mod scene;
pub mod transport;
pub mod verify;
mod weld;

pub use rebounce_shared as shared;
pub use rebounce_shared::random;
