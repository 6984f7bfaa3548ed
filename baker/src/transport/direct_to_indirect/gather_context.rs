//! What gathers read, and what one costs.

use super::OperatorSettings;
use super::hit_cache::HitCache;
use super::neighbourhood::SenderBlocks;
use crate::basis::{Leveled, Relations};
use crate::geometry::Surfaces;
use crate::sampling::Points;
use glam::Vec3A;

/// What all gathers read.
pub struct GatherContext<'a, S: Surfaces + ?Sized> {
    /// The scene.
    pub surfaces: &'a S,
    /// All points.
    pub points: &'a Points,
    /// Parents and children.
    pub relations: &'a Relations,
    /// The sender levels' functions, coarsest first.
    pub senders: &'a Leveled,
    /// Number of points on the levels that later bounces travel between.
    pub coarse_count: usize,
    /// What rays find on each tile of the surfaces, where they tell their pieces.
    pub tiles: Option<&'a HitCache>,
    /// The [duals](super::tint::duals) of the points' tints.
    pub duals: &'a [Vec3A],
    /// Where the senders are, roughly.
    pub sender_blocks: &'a SenderBlocks,
    /// Settings.
    pub settings: &'a OperatorSettings,
}

/// What one gather leaves besides links.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GatherCost {
    /// Rays cast.
    pub rays: u64,
    /// Cosine-weighted reflectance seen.
    pub seen: f64,
    /// The part of it that no sender covers.
    pub lost: f64,
}

/// Index in an accumulator of what rays gathered from a sender.
pub const GATHERED: usize = 0;
/// Index of what the parents' values predict.
pub const PREDICTED: usize = 1;
