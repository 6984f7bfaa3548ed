//! Light straight from the lamps.

pub mod direct;
