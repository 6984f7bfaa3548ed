//! Bakes how light bounces through a scene. Data flows one way:
//! scene → points → basis → operator → file.

pub mod bake;
pub mod basis;
pub mod light;
mod morton;
pub mod operator;
pub mod path_trace;
pub mod picture;
pub mod points;
mod processor;
pub mod render;
pub mod scene;
pub mod shot;
pub mod simplify;
pub mod surface;
pub mod team;
pub mod triangles;
pub mod watch;
mod weld;
pub mod write;

pub use rebounce_shared::random;
