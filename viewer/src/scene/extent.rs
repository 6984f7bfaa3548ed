//! Bounds of a scene: all of it, and its detailed part.

use glam::Vec3;

/// Ratio of widths above which a scene counts as far larger than its detailed part.
const FAR_LARGER: f32 = 4.0;

/// Bounds covered by shadow maps, local space: minimum and maximum corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Bounds of the scene.
    pub all: [Vec3; 2],
    /// Bounds of the detailed part of a far larger scene: a directional light has an additional map for this part.
    pub detail: Option<[Vec3; 2]>,
}

impl Extent {
    /// Extent of a scene with bounds `all`; `finest` are the bounds of the finest functions.
    pub fn new(all: [Vec3; 2], finest: [Vec3; 2]) -> Self {
        let width = |[low, high]: [Vec3; 2]| (high - low).length();
        let is_far_larger = width(finest) > 0.0 && width(all) > FAR_LARGER * width(finest);
        Self { all, detail: is_far_larger.then_some(finest) }
    }
}
