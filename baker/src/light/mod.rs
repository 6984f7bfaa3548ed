//! Direct light from the lamps.

pub mod direct;
pub mod level;
pub mod sized;
