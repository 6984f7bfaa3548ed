//! Code shared by the Rebounce baker and viewer.
//!
//! The crate is free of I/O and GPU code, and compiles to native and wasm:
//!
//! * `antiradiance` – bounced light without visibility, on the CPU, the reference for the GPU;
//! * [`kernel`] – the weight function of the meshless basis (Lehtinen et al. 2008, Eq. 8 to 10);
//! * [`basis`] – functions that cover a place, parents and children;
//! * [`clip_planes`] – planes that end supports at walls; [`surroundings`] – the surfaces around a point;
//! * [`footprint`] – sample places of direct light around a point;
//! * [`openness`] – effect of near surfaces on the light between points;
//! * `harmonics` – spherical harmonics; `ggx`, `gloss` – how rough metals and varnish reflect;
//! * `cube_map` – rays through cube maps of the surroundings of metals, and light in them;
//! * `diffuse_transfer` – irradiance of the points of a file that is for an environment;
//! * [`elementary`] – elementary functions with the same bits on every platform;
//! * [`environment`] – light from infinitely far: pictures, bins, suns, daylight;
//! * [`exposure`] – limit of the automatic exposure;
//! * [`octahedral`], [`colour`], [`link`], [`interpolation`] – the packed numbers of the bulk sections;
//! * [`random`] – random numbers as pure functions of their arguments;
//! * [`rbn`] – the .rbn file: header, sections, checksums, metadata;
//! * [`exposure`], [`backdrop`] – brightness of a picture, and background of an object;
//! * [`tone`], [`smooth`] – display values from radiance, and antialiasing of their edges;
//! * `radiosity` – bounced light of scenes whose things move, on the CPU, the reference for the GPU;
//! * [`motion`] – rigid motions of nodes;
//! * `rig` – meshes that animations deform;
//! * [`relight`] – one frame of relighting on the CPU, the reference for the GPU;
//! * [`shot`], [`light`], [`camera`] – a picture to take: SHOT.json, lights and cameras.
//!
//! "Paper" below is Lehtinen et al., *A Meshless Hierarchical Representation for Light
//! Transport*, ACM Transactions on Graphics 27(3), 2008.

#[cfg(feature = "antiradiance")]
pub mod antiradiance;
pub mod backdrop;
pub mod baked;
pub mod basis;
pub mod camera;
pub mod clip_planes;
pub mod colour;
#[cfg(feature = "radiosity")]
pub mod cube_map;
#[cfg(feature = "radiosity")]
pub mod diffuse_transfer;
pub mod elementary;
pub mod environment;
pub mod exposure;
pub mod footprint;
#[cfg(feature = "radiosity")]
pub mod ggx;
#[cfg(feature = "radiosity")]
pub mod gloss;
#[cfg(feature = "radiosity")]
pub mod harmonics;
pub mod interpolation;
pub mod kernel;
pub mod light;
pub mod light_group;
pub mod lighting;
#[cfg(feature = "radiosity")]
pub mod lightmap;
pub mod link;
pub mod mix;
pub mod motion;
pub mod octahedral;
pub mod openness;
#[cfg(feature = "radiosity")]
pub mod radiosity;
pub mod random;
pub mod rbn;
pub mod relight;
#[cfg(feature = "radiosity")]
pub mod rig;
pub mod shot;
pub mod smooth;
pub mod surroundings;
pub mod tone;

pub use glam;

/// Hash of the contents of this crate's sources, hexadecimal.
pub const SOURCES: &str = env!("REBOUNCE_SHARED_SOURCES");
