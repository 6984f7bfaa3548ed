//! Radiosity without links, for scenes whose things move: hierarchical gathers over the points of a file, after Schäfer et al.
//! 2011, *Meshless Radiosity on the GPU* ("the 2011 paper"), which continues Lehtinen et al. 2007.
//!
//! Here is the arithmetic on the CPU; the viewer has the same in WGSL, stage by stage:
//!
//! | stage | here | WGSL |
//! |---|---|---|
//! | ray traversal: a BVH an object, and one above | [`traversal`] | `bvh.wgsl` |
//! | directions of the rays | [`directions`] | `hemisphere.wgsl` |
//! | unshot light at a hit | [`reconstruction`] | `reconstruct.wgsl` |
//! | gather: the mean over the rays | [`gather`] | `gather_light.wgsl` |
//! | pull-down, refinement oracle | [`levels`] | `pull_down.wgsl` |
//!
//! [`accelerator`] builds the BVHs; [`solver`] has the passes in order. [`clipping`] works out anew the clip planes of functions
//! that something has moved to or from ([`touched`]), by rays at the [`placed_surfaces`].
//!
//! Values are absolute on every level (5 of the 2011 paper): each level is a flat representation of the light by itself.

pub mod accelerator;
pub mod clipping;
pub mod directions;
pub mod gather;
pub mod levels;
pub mod placed_surfaces;
pub mod reconstruction;
pub mod solver;
pub mod touched;
pub mod traversal;

pub use accelerator::{Accelerator, PlacedModels};
pub use clipping::{ClippedFunctions, Clipping};
pub use gather::{Gather, Gathered};
pub use reconstruction::Reconstruction;
pub use solver::{RadiositySettings, Solution, solve};
