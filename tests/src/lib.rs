//! Tests that span crates, and what they need: pictures of linear radiance, compared.

pub mod difference;
pub mod float_picture;
