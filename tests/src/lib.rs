//! Tests that span crates, and what they need: pictures of linear radiance, from the browser too.

pub mod float_picture;
