//! Differences between pictures.
//!
//! * [`error`] – error, bias and 95th percentile against a reference; [`uncertainty`] – their confidence interval with
//!   noisy references;
//! * [`flip`] – visibility of a difference to the eye;
//! * [`spots`] – spottiness of bare surfaces.

pub mod error;
pub mod flip;
pub mod spots;
pub mod uncertainty;

pub use error::{CompareError, Comparison, compare, noticed, signed_difference};
