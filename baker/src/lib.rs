//! Bakes how light bounces through a scene. Data flows one way:
//! scene → points → basis → operator → file.

pub mod bake;
pub mod basis;
pub mod communicator;
pub mod geometry;
pub mod light;
mod morton;
pub mod path_trace;
pub mod picture;
mod processor;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod shot;
pub mod transport;
pub mod watch;
mod weld;
pub mod write;

pub use rebounce_shared::random;
