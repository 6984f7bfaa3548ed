//! Support for tests that span crates: pictures of linear radiance, from the browser too; small bakes; damaged files.

pub mod damage;
pub mod float_picture;
pub mod small;
