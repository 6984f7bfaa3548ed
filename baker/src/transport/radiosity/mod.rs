//! Hierarchical progressive radiosity for lights that stay in place (Lehtinen et al. 2007, *Meshless Finite Elements for
//! Hierarchical Global Illumination*, section 6.3; "the report" in this module).
//!
//! Unlike the operator, which answers for any light, a solution knows its lights: only receivers near which their bounced
//! light varies are gathered for.
//!
//! * [`settings`] – rays and thresholds;
//! * [`direct`] – direct irradiance of the points by group of light;
//! * [`sender_level`] – the level at which a hit is evaluated, by solid angle (ε_Ω);
//! * [`gather`] – irradiance of receivers by the rays of their hemispheres (procedure GATHER);
//! * [`receiver_oracle`] – which receivers are refined (ε_E);
//! * [`bounces`] – light that bounces between coarse points; [`ancestors`] – coarse points that a finer one follows from;
//! * [`mod@source_links`] – light from the sky and from emissive surfaces;
//! * [`solver`] – levels and bounces in order; [`solution`] – what it finds.

pub mod ancestors;
pub mod bounces;
pub mod direct;
pub mod gather;
pub mod receiver_oracle;
pub mod sender_level;
pub mod settings;
pub mod solution;
pub mod solver;
pub mod source_links;

pub use direct::{GroupField, GroupSource, linked_irradiance};
pub use settings::RadiositySettings;
pub use solution::{FixedSolution, GatherCount};
pub use solver::ProgressiveRadiosity;
pub use source_links::source_links;
