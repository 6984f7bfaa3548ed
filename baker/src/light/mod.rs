//! Direct light: from lamps, from area lights, and from all that shines.
//!
//! * [`direct`] – irradiance from lamps and area lights;
//! * [`area`] – sampling of rectangles, disks and spheres; [`sized`] – of lamps with a size;
//! * [`illumination`] – all that shines, with multiple importance sampling;
//! * [`level`] – level of a scene's direct light.

pub mod area;
pub mod direct;
pub mod illumination;
pub mod level;
pub mod sized;
