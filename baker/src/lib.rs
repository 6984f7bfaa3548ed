//! Bakes how light bounces through a scene. Data flows one way:
//! scene → points → basis → operator → file.

pub mod bake;
pub mod basis;
pub mod demo;
pub mod geometry;
pub mod io;
pub mod job;
mod lanes;
pub mod light;
mod morton;
mod processor;
pub mod sampling;
pub mod scene;
pub mod transport;
pub mod verify;
mod weld;

pub use rebounce_shared::random;
