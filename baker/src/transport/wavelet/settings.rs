//! Settings and errors.

use super::basis::Order;
use crate::job::watch::Stopped;

/// Accuracy of wavelet radiosity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveletSettings {
    /// Order of the basis.
    pub order: Order,
    /// Part of the power that has been shot when it ends, 0 to 1: (Eᵢ − Eᵣ) / Eᵢ of Alonso et al. 2001,
    /// section 6.
    pub convergence: f64,
    /// Error of irradiance at control points: part of that irradiance and of the mean irradiance that the
    /// shot would give to all surfaces, together. Cells of receivers are divided above it, cells of emitters
    /// above a quarter of it.
    pub epsilon: f64,
    /// Cells smaller than this are not divided, square scene units; nor those smaller than 4⁻ᵈ of a square, d
    /// = `max_level`.
    pub min_cell_area: f64,
    /// Levels of receivers that are divided wherever there is more light than the tolerance.
    pub min_level: u32,
    /// Deepest level of the quadtrees of receivers.
    pub max_level: u32,
    /// Deepest level of the cells of emitters.
    pub max_emitter_level: u32,
    /// Shots after which it ends anyway.
    pub max_shots: usize,
}

impl Default for WaveletSettings {
    fn default() -> Self {
        Self {
            order: Order::default(),
            convergence: 0.99,
            epsilon: 0.05,
            min_cell_area: 0.0,
            min_level: 1,
            max_level: 4,
            max_emitter_level: 7,
            max_shots: 1_000_000,
        }
    }
}

/// Greatest error of irradiance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tolerance {
    /// Where there is none.
    pub least: f64,
    /// More, part of the irradiance.
    pub relative: f64,
}

impl Tolerance {
    /// Where there is this irradiance.
    pub(super) fn at(&self, irradiance: f64) -> f64 {
        self.least + self.relative * irradiance
    }
}

/// Why wavelet radiosity did not come to its end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WaveletError {
    /// The transform is singular, or does not scale a curved face uniformly.
    #[error("patch {patch} has a transform that does not keep proportions of areas")]
    Transform {
        /// Index of the patch.
        patch: usize,
    },
    /// An albedo above 1, or a colour below 0 or not finite.
    #[error("patch {patch} has an albedo or emission out of range")]
    Material {
        /// Index of the patch.
        patch: usize,
    },
    /// It was cancelled.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}
