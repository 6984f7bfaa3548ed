//! What the Rebounce baker and viewer share.
//!
//! Everything here is free of I/O and of GPU code, and compiles to native and to wasm alike:
//!
//! * [`kernel`] – the weight function of the meshless basis (Lehtinen et al. 2008, Eq. 8 to 10);
//! * [`basis`] – which functions cover a place, and who is whose parent and child;
//! * [`footprint`] – where direct light is sampled around a point;
//! * [`openness`] – what near surfaces leave of the light between points;
//! * [`exposure`] – how far an automatic exposure may go;
//! * [`octahedral`], [`colour`], [`link`], [`interpolation`] – the packed numbers of the bulk sections;
//! * [`random`] – random numbers that depend on nothing but their arguments;
//! * [`rbn`] – the .rbn file: header, sections, checksums, metadata;
//! * [`exposure`], [`backdrop`] – how bright a picture is shown, and what it shows behind an object;
//! * [`tone`], [`smooth`] – display values from radiance, and their edges smoothed;
//! * [`relight`] – one frame of relighting on the CPU, the truth that the GPU is held against;
//! * [`shot`], [`light`], [`camera`] – a picture to take: SHOT.json, lights and cameras.
//!
//! "Paper" below is Lehtinen et al., *A Meshless Hierarchical Representation for Light
//! Transport*, ACM Transactions on Graphics 27(3), 2008.

pub mod backdrop;
pub mod baked;
pub mod basis;
pub mod camera;
pub mod colour;
pub mod exposure;
pub mod footprint;
pub mod interpolation;
pub mod kernel;
pub mod light;
pub mod link;
pub mod octahedral;
pub mod openness;
pub mod random;
pub mod rbn;
pub mod relight;
pub mod shot;
pub mod smooth;
pub mod tone;

pub use glam;
