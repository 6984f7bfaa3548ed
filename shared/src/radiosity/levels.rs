//! Pull-down of light from coarse to fine levels, and the oracle that chooses receivers (the 2011 paper, 5). Twin of
//! `pull_down.wgsl`.

use super::gather::Gathered;
use crate::interpolation::{Rows, mean};
use glam::Vec3;

/// The illumination of a point as its parents have it: the mean by their weights at the point. `None` without parents.
pub fn pulled_down(push: Rows<'_>, i: usize, values: &[Vec3]) -> Option<Vec3> {
    mean(push.row(i), Vec3::ZERO, |parent| values[parent])
}

/// Whether a point is gathered for: a parent is refined, or there is none.
pub fn is_wanted(push: Rows<'_>, i: usize, refined: &[bool]) -> bool {
    let parents = push.row(i);
    parents.is_empty() || parents.iter().any(|parent| refined[parent.point()])
}

/// Oracle: whether the children of a point are gathered for. They are where what was gathered differs from what the parents
/// have by more than `epsilon` of itself, and of a share of the mean irradiance: darker differences are not seen.
pub fn is_refined(gathered: Vec3, pulled_down: Vec3, epsilon: f32, mean: f32) -> bool {
    let [own, coarse] = [gathered, pulled_down].map(|light| light.element_sum() / 3.0);
    (own - coarse).abs() > epsilon * own.max(coarse).max(DIM * mean)
}

/// Share of the mean irradiance under which differences count as much as at it.
pub const DIM: f32 = 0.25;

/// Returns the part of what was gathered that stands out of its noise: what the parents have, plus the difference shrunk by
/// the share of noise in its square (Wiener's filter). `significance` is in standard deviations.
pub fn significant(gathered: &Gathered, pulled_down: Vec3, significance: f32) -> Vec3 {
    let difference = gathered.irradiance - pulled_down;
    let square = difference.length_squared() / 3.0;
    let noise = significance * significance * gathered.variance;
    pulled_down + difference * if square > noise { 1.0 - noise / square } else { 0.0 }
}
