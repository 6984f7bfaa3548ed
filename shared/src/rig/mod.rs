//! Rigs: meshes that deform. A hierarchy of nodes that animations pose, linear blend skinning (glTF 2.0, 3.7.3.3), morph targets
//! (3.7.2.2).
//!
//! * [`rbn::rig_layout`](crate::rbn::rig_layout) – what a file has of them;
//! * [`keys`] – between keys;
//! * [`pose`] – the hierarchy at a moment of an animation: matrices of joints, weights of morph targets;
//! * [`skin`] – vertices in a pose: the twin of `skin.wgsl`; points that ride on the triangles.

pub mod keys;
pub mod pose;
pub mod skin;

pub use crate::rbn::rig_layout::*;
