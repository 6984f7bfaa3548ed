//! B-splines: basis functions, Bézier pieces of NURBS surfaces, and where rays meet them.

pub mod basis;
#[cfg(test)]
pub(crate) mod samples;
