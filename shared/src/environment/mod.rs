//! Light from infinitely far: environments, their bins, their sun, their packed form, and daylight.
//!
//! * [`picture`] – [`Environment`]: equirectangular radiance, orientation, rotation, reduction;
//! * [`bins`] – equal-area bins of the sphere, and an environment's mean radiance in each;
//! * `reflection` – an environment as surfaces reflect it;
//! * [`sun`] – a disk too small and bright for the bins becomes a directional light;
//! * `mips` – an environment in ever fewer pixels;
//! * [`packed`] – the form that travels in a file;
//! * [`daylight`] – analytic sky and sun of a clear day.

pub mod bins;
pub mod daylight;
#[cfg(feature = "radiosity")]
pub mod mips;
pub mod packed;
pub mod picture;
#[cfg(feature = "radiosity")]
pub mod reflection;
pub mod sun;

pub use packed::{PackedEnvironment, PackedEnvironmentError};
pub use picture::{Environment, direction_at, environment_from_world, world_from_environment};
pub use sun::{Sun, extract_sun};
