//! Support for tests that span crates: pictures of linear radiance, from the browser too; small bakes; damaged files; a vase.

pub mod damage;
pub mod float_picture;
pub mod small;
pub mod vase;
