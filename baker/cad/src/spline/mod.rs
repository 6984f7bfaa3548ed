//! B-splines: basis functions, Bézier pieces of NURBS surfaces, and where rays meet them.

pub mod bezier_patch;
pub(crate) mod inversion;
pub mod meet;
mod over_surface;
pub mod roots;
#[cfg(test)]
pub(crate) mod samples;
pub mod split;

pub use bezier_patch::BezierPatch;
pub use split::patches;
