//! Exact surfaces of CAD models, after ISO 10303-42 (the geometry of STEP files). Double precision; lengths in metres, y up,
//! once a reader has converted them.
//!
//! | module | what it has |
//! |---|---|
//! | [`frame`] | placements |
//! | [`curve`] | lines, conics, NURBS curves |
//! | [`surface`] | planes, quadrics, tori, surfaces of revolution and extrusion, NURBS surfaces |
//! | [`spline`] | Bézier pieces of NURBS surfaces, and where rays meet them |
//! | [`trim`] | trimmed domains: trapezoidal maps |
//! | [`tessellate`] | triangles of trimmed faces, for the screen |
//! | [`face`] | trimmed surfaces |
//! | [`model`] | parts of an assembly |
//!
//! Data flows one way: a curve knows no surface, a surface no trim, a face no model.

pub mod basis;
pub mod cast;
pub mod curve;
pub mod face;
pub mod frame;
pub mod model;
pub mod spline;
pub mod surface;
pub mod tessellate;
pub mod trim;
