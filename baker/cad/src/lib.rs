//! Exact surfaces of CAD models, after ISO 10303-42 (the geometry of STEP files). Double precision; lengths in metres, y up,
//! once a reader has converted them.
//!
//! | module | what it has |
//! |---|---|
//! | [`frame`] | placements |
//! | [`basis`] | B-spline basis functions |
//! | [`curve`] | lines, conics, NURBS curves |
//! | [`surface`] | planes, quadrics, tori, surfaces of revolution and extrusion, NURBS surfaces |
//! | [`spline`] | Bézier pieces of NURBS surfaces, and where rays meet them |
//! | [`trim`] | trimmed domains: trapezoidal maps |
//! | [`face`] | trimmed surfaces |
//! | [`cast`] | faces cut into pieces for rays |
//! | [`tessellate`] | triangles of faces, for the screen |
//! | [`model`] | parts of an assembly |
//! | [`demo`] | generated scenes |
//! | [`virtual_mesh`] | faces mapped to unit squares, areas in proportion |
//! | `step` | reader of STEP files; with the feature `step` |
//!
//! Data flows one way: a curve knows no surface, a surface no trim, a face no model.

pub mod basis;
pub mod cast;
pub mod curve;
pub mod demo;
pub mod face;
pub mod frame;
pub mod model;
mod quadrature;
#[cfg(test)]
mod random;
pub mod spline;
#[cfg(feature = "step")]
pub mod step;
pub mod surface;
pub mod tessellate;
pub mod trim;
pub mod virtual_mesh;
