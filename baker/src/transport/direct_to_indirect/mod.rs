//! The direct-to-indirect operator S (paper, section 3).
//!
//! * [`mean_albedo`] – mean albedo of the scene; ε is relative to the mean albedo;
//! * [`tint`] – colours of the senders;
//! * [`directions`] – ray directions of a hemispherical gather;
//! * [`hemisphere`] – gather rays of a receiver;
//! * [`senders`] – the senders' functions, hit cache and blocks;
//! * [`hit_cache`] – precomputed basis weights and light for tiles of the surfaces;
//! * [`ray_sort`] – order of the rays in a gather batch;
//! * [`gather_batch`] – casts and shades the rays of several receivers;
//! * [`gather_context`] – inputs and cost of a gather;
//! * [`gather`] – Eq. 16 for a receiver and all senders, and the differences of Eq. 17;
//! * [`accumulator`] – sums of a gather by sender;
//! * [`neighbourhood`] – sharing of gathered differences between receivers;
//! * [`sparsify`] – selection of row entries that become links;
//! * [`refine`] – the adaptive queue of Fig. 5: the one-bounce operator T;
//! * [`pairwise`] – T by refining links one at a time instead; `pair_links` – their rows;
//! * `coarse_matrix` – coarse transport matrix C between the coarse points;
//! * [`bounces`] – later bounces: S, by the [`series`] of bounces between coarse points;
//! * [`solver`] – the stages in order, with progress, checkpoint and processes; `messages` – their results as bytes.
//!
//! All modules but the last are pure: equal inputs give equal results. Those that tests and benches alone use from outside
//! are hidden in the documentation.

pub(super) mod accumulator;
#[doc(hidden)]
pub mod bounces;
mod coarse_matrix;
#[doc(hidden)]
pub mod directions;
#[doc(hidden)]
pub mod gather;
#[doc(hidden)]
pub mod gather_batch;
#[doc(hidden)]
pub mod gather_context;
#[doc(hidden)]
pub mod hemisphere;
#[doc(hidden)]
pub mod hit_cache;
pub mod mean_albedo;
mod messages;
mod neighbourhood;
mod pair_links;
pub mod pairwise;
#[doc(hidden)]
pub mod ray_sort;
#[doc(hidden)]
pub mod refine;
#[doc(hidden)]
pub mod senders;
mod series;
pub mod solver;
mod sparsify;
pub mod tint;

pub use super::operator::{Operator, OperatorSettings, Refinement};
pub use solver::DirectToIndirect;
pub(super) use solver::colours;
