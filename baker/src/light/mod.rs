//! Direct light: from lamps, from area lights, and from all that shines.
//!
//! * [`direct`] – irradiance from lamps and area lights;
//! * [`area`] – sampling of rectangles, disks and spheres; [`sized`] – of lamps with a size;
//! * [`far`] – light from infinitely far; [`environment_map`] – sampling of an environment's picture;
//! * [`bsdf`] – how surfaces reflect light to an eye;
//! * [`illumination`] – all that shines, with multiple importance sampling;
//! * [`level`] – level of a scene's direct light.

pub mod area;
pub mod bsdf;
pub mod direct;
pub mod environment_map;
pub mod far;
pub mod illumination;
pub mod level;
pub mod sized;
