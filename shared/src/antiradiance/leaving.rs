//! Direct light at patches, and exitant radiance of patches.

use super::hierarchy::{Element, NONE};
use glam::Vec3;

/// Radiance that leaves patches.
#[derive(Clone, Copy)]
pub struct Leaving<'a> {
    /// By patch, to all its front.
    pub matt: &'a [Vec3],
    /// By glossy patch and bin.
    pub lobes: &'a [Vec3],
    /// Number of bins.
    pub bins: usize,
}

impl Leaving<'_> {
    /// That of a patch by a bin.
    #[inline]
    pub fn by(&self, patch: &Element, bin: usize) -> Vec3 {
        let matt = self.matt[patch.first as usize];
        if patch.glossy == NONE { matt } else { matt + self.lobes[patch.glossy as usize * self.bins + bin] }
    }
}

/// Direct light at patches.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DirectLight {
    /// Irradiance by patch.
    pub irradiance: Vec<Vec3>,
    /// What of it comes by each bin, by glossy patch and bin.
    pub by_bin: Vec<Vec3>,
}
