//! A fixed solution: bounced light of every point for lights that stay in place.

use super::direct::{GroupField, GroupSource};
use crate::sampling::{PointLevel, Points};

/// Share of the mean bounced irradiance that is negligible.
const NEGLIGIBLE: f32 = 1.0 / 500.0;

/// Figures of a level.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct GatherCount {
    /// Points.
    pub points: u64,
    /// Points that were gathered for.
    pub gathered: u64,
}

/// Light at the points per unit strength of each group of light, and what it cost.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FixedSolution {
    /// Bounced irradiance, linear RGB.
    pub bounced: GroupField,
    /// Irradiance straight from the sky and from emissive surfaces; zeros for lamps.
    pub linked: GroupField,
    /// Whether each group has a part in [`Self::linked`].
    pub has_direct: Vec<bool>,
    /// Whether each point was gathered for; others have the mean of their parents.
    pub is_gathered: Vec<bool>,
    /// Irradiance by group that is negligible beside the group's bounced light.
    pub floors: Vec<f32>,
    /// Figures by level, coarsest first.
    pub levels: Vec<GatherCount>,
    /// Rays cast in gathers.
    pub rays: u64,
    /// Rays cast for the sky and for emissive surfaces.
    pub source_rays: u64,
    /// Number of bounces.
    pub bounces: u32,
    /// Seconds of all threads together: in casting rays, and in evaluating functions.
    pub gather_seconds: [f64; 2],
}

impl FixedSolution {
    /// A solution at `count` points with nothing gathered yet: zeros beside the `linked` irradiance, which took
    /// `source_rays`.
    pub fn new(count: usize, groups: &[GroupSource], linked: GroupField, source_rays: u64) -> Self {
        Self {
            bounced: GroupField::new(count, groups.len()),
            linked,
            has_direct: groups.iter().map(|group| group.has_links).collect(),
            is_gathered: vec![false; count],
            source_rays,
            ..Self::default()
        }
    }

    /// Counts the gathered points of each level, and sets the floors to a share of each group's mean: for solvers that have
    /// the light of all points.
    pub fn measure(&mut self, points: &Points) {
        let of_level = |level: &PointLevel| GatherCount {
            points: level.count as u64,
            gathered: level.range().filter(|i| self.is_gathered[*i]).count() as u64,
        };
        self.levels = points.levels.iter().map(of_level).collect();
        let count = self.is_gathered.len().max(1) as f32;
        let floor = |group: usize| {
            let sum: f32 = self.bounced.group(group).map(|value| value.element_sum() / 3.0).sum();
            (NEGLIGIBLE * sum / count).clamp(1e-12, 1e12)
        };
        self.floors = (0..self.has_direct.len()).map(floor).collect();
    }
}
