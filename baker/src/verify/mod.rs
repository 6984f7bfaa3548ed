//! Verification of a bake: ground truth, the CPU renderer, and the difference between the two. Independent of
//! [`transport`](crate::transport), so that an error there cannot hide itself.
//!
//! * [`path_trace`] – brute-force path tracer: ground truth;
//! * [`render`](mod@render) – CPU reference renderer of a baked file: the viewer's twin;
//! * [`expose`] – average of the samples of each pixel;
//! * [`compare`] – error measures between two pictures.

pub mod compare;
pub mod expose;
pub mod path_trace;
pub mod render;
