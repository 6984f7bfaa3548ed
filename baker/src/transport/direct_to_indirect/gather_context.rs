//! Input and cost of gathers.

use super::OperatorSettings;
use super::hit_cache::HitCache;
use super::neighbourhood::SenderBlocks;
use crate::basis::{Leveled, Relations};
use crate::geometry::Surfaces;
use crate::sampling::Points;
use glam::Vec3A;

/// Read-only input of all gathers.
pub struct GatherContext<'a, S: Surfaces + ?Sized> {
    /// Surfaces of the scene.
    pub surfaces: &'a S,
    /// All points.
    pub points: &'a Points,
    /// Parents and children of the points.
    pub relations: &'a Relations,
    /// Functions of the sender levels, coarsest first.
    pub senders: &'a Leveled,
    /// Number of points on the levels of later bounces.
    pub coarse_count: usize,
    /// Hit cache; `None` for surfaces without primitives.
    pub tiles: Option<&'a HitCache>,
    /// The [duals](super::tint::duals) of the points' tints.
    pub duals: &'a [Vec3A],
    /// Bounding spheres of blocks of senders.
    pub sender_blocks: &'a SenderBlocks,
    /// Settings of the operator.
    pub settings: &'a OperatorSettings,
}

/// Cost and lost light of a gather.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GatherCost {
    /// Number of rays cast.
    pub rays: u64,
    /// Cosine-weighted reflectance at the hits.
    pub seen: f64,
    /// Part of `seen` at hits without a sender function.
    pub lost: f64,
}

/// Index in an accumulator of the irradiance gathered from a sender.
pub const GATHERED: usize = 0;
/// Index of the irradiance predicted by the parents' values.
pub const PREDICTED: usize = 1;
