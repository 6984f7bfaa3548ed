//! Hierarchical progressive radiosity for lights that stay in place (Lehtinen et al. 2007, *A Meshless Hierarchical
//! Representation for Light Transport*, technical report "Meshless Finite Elements for Hierarchical Global Illumination",
//! section 6.3, "the report" below).
//!
//! Unlike the operator, which answers for any light, a solution knows its lights: only receivers near which their bounced
//! light varies are gathered for.
//!
//! * [`settings`] – rays and thresholds;
//! * [`direct`] – direct irradiance of the points by group of light;
//! * [`sender_level`] – the level at which a hit is evaluated, by solid angle (ε_Ω);
//! * [`gather`] – irradiance of receivers by the rays of their hemispheres (procedure GATHER);
//! * [`receiver_oracle`] – which receivers are refined (ε_E);
//! * [`bounces`] – light that bounces between coarse points;
//! * [`solver`] – levels and bounces in order; [`solution`] – what it finds.

pub mod bounces;
pub mod direct;
pub mod gather;
pub mod receiver_oracle;
pub mod sender_level;
pub mod settings;
pub mod solution;
pub mod solver;

pub use direct::GroupSource;
pub use settings::RadiositySettings;
pub use solution::{FixedSolution, GatherCount};
pub use solver::ProgressiveRadiosity;
