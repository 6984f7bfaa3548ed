//! The direct-to-indirect operator S (paper, section 3).
//!
//! * [`directions`] – the rays of one hemispherical gather;
//! * [`gather`] – Eq. 16 for one receiver and all senders, and Eq. 17's differences;
//! * [`refine`] – the adaptive queue of Fig. 5: the one-bounce operator T;
//! * [`bounces`] – later bounces by the Neumann series: S.

pub mod bounces;
pub mod directions;
pub mod gather;
pub mod refine;

use rebounce_shared::link::Link;

/// How the operator is computed.
#[derive(Clone, Debug, PartialEq)]
pub struct OperatorSettings {
    /// Senders are the functions of this many coarsest levels.
    pub sender_levels: usize,
    /// Links whose magnitude (irradiance per unit irradiance) is under this are dropped, but for
    /// those that carry the mean: from the coarsest senders to the coarsest receivers.
    pub epsilon: f32,
    /// Rays per receiver, by level; the last entry holds for all finer levels.
    pub rays: Vec<u32>,
    /// Links under this many standard deviations of their own Monte Carlo noise are dropped.
    pub significance: f32,
    /// Bounces of light; `None`: until the energy left is negligible.
    pub bounces: Option<u32>,
    /// Later bounces reach, and start from, the functions of this many coarsest levels.
    pub later_levels: usize,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl OperatorSettings {
    /// Rays per receiver on a level.
    pub fn rays_on(&self, level: usize) -> u32 {
        self.rays.get(level).or(self.rays.last()).copied().unwrap_or(512)
    }
}

/// The operator: links by receiver, and what it took.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Operator {
    /// For every point its links, columns ascending; empty where it receives nothing of its own.
    pub rows: Vec<Vec<Link>>,
    /// Rays cast.
    pub rays: u64,
    /// Receivers whose links were computed.
    pub receivers: u64,
    /// Share of the reflected light that no sender's function covers, and that is lost.
    pub lost_share: f64,
    /// Bounces that the operator holds.
    pub bounces: u32,
}

impl Operator {
    /// Number of links.
    pub fn link_count(&self) -> u64 {
        self.rows.iter().map(|row| row.iter().filter(|link| !link.is_page()).count() as u64).sum()
    }
}
