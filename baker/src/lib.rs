//! Bakes how light bounces through a scene. Data flows one way:
//! scene → points → basis → operator → file.

pub mod bake;
pub mod basis;
pub mod operator;
pub mod points;
pub mod random;
pub mod scene;
pub mod surface;
pub mod triangles;
pub mod write;
