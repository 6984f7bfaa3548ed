//! Exact surfaces of CAD models, after ISO 10303-42 (the geometry of STEP files). Double precision; lengths in metres, y up,
//! once a reader has converted them.
//!
//! | module | what it has |
//! |---|---|
//! | [`frame`] | placements |
//! | [`curve`] | lines, conics, NURBS curves |
//! | [`surface`] | planes, quadrics, tori, surfaces of revolution and extrusion, NURBS surfaces |
//! | [`trim`] | trimmed domains: trapezoidal maps |
//! | [`face`] | trimmed surfaces |
//! | [`model`] | parts of an assembly |
//! | `step` | reader of STEP files; behind the feature `step` |
//!
//! Data flows one way: a curve knows no surface, a surface no trim, a face no model.

pub mod curve;
pub mod face;
pub mod frame;
pub mod model;
#[cfg(feature = "step")]
pub mod step;
pub mod surface;
pub mod trim;
