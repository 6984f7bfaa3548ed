//! Where rays meet Bézier patches.

use super::bezier_patch::BezierPatch;
use super::roots::PlaneNet;
use crate::surface::{Ray, SurfaceHit};
use glam::{DVec2, DVec3, DVec4};
use smallvec::SmallVec;

/// How near the ray must pass, in multiples of the patch's size, to touch it where nothing tells it from a touch.
const TOUCH: f64 = 1e-12;

/// How near meetings of neighbouring patches are the same, in multiples of the patch's size or of its range.
const SAME: f64 = 1e-9;

impl BezierPatch {
    /// Adds all meetings of a ray with the patch, borders included, at distances from the first to the second.
    ///
    /// Two planes through the ray turn its meetings into the roots of two polynomials in u and v, a · (P - w O) = 0 for both
    /// normals a (Kajiya 1982), which [`PlaneNet::roots`] finds by subdivision. SurfaceHits are within 10⁻¹¹ of the patch's size of
    /// the ray, or within rounding errors where those are larger (a ray from afar). A ray that touches the patch, or passes it
    /// by less than 10⁻¹² of its size, meets it once; one that runs within it, at some points. Poles, where an edge is one
    /// point, are met once.
    ///
    /// `found` may hold meetings of other patches of the same surface, and of no other: what lies on the patch's border at the
    /// distance of one of those is that one.
    pub fn meet(&self, ray: &Ray, distances: [f64; 2], found: &mut Vec<SurfaceHit>) {
        let mut all: SplineHits = found.as_slice().into();
        self.meet_within(&self.bounds(), ray, distances, &mut all);
        found.extend_from_slice(&all[found.len()..]);
    }

    /// As [`Self::meet`], by the patch's [`Self::bounds`].
    pub(crate) fn meet_within(
        &self,
        bounds: &[DVec3; 2],
        ray: &Ray,
        distances: [f64; 2],
        found: &mut SplineHits,
    ) {
        let mut poles = PlanePoles::new();
        let Some(view) = View::new(self, bounds, ray, &mut poles) else { return };
        let may_meet = view.depths[0] <= distances[1] && view.depths[1] >= distances[0];
        if !may_meet {
            return;
        }
        let others = found.len();
        for unit in view.net.roots() {
            let distance = view.distance(self, unit);
            if !(distances[0]..=distances[1]).contains(&distance) {
                continue;
            }
            let is_border = unit.min(1.0 - unit).min_element() <= SAME;
            let near = SAME * view.size;
            if is_border && found[..others].iter().any(|other| (other.distance - distance).abs() <= near) {
                continue;
            }
            // Exact at both ends.
            let at = self.range[0] * (1.0 - unit) + self.range[1] * unit;
            found.push(SurfaceHit { distance, at });
        }
    }
}

/// Meetings of a ray with a spline, on the stack up to four.
pub(crate) type SplineHits = SmallVec<[SurfaceHit; 4]>;

/// Control points of a plane, on the stack up to degrees 5 and 5.
type PlanePoles = SmallVec<[DVec2; 36]>;

/// A patch as seen along a ray.
struct View<'a> {
    /// Coordinates across the ray, times the weight.
    net: PlaneNet<'a>,
    /// Bounds of the distance, from the control points.
    depths: [f64; 2],
    /// Distance at the foot of the patch's middle, from which depths are measured.
    foot: f64,
    /// That foot.
    origin: DVec3,
    /// Multiplies a vector to a distance.
    along: DVec3,
    /// The patch's size, as a distance.
    size: f64,
}

impl<'a> View<'a> {
    /// `None` if numbers are not finite, the direction is 0, or the patch is smaller than rounding errors at this distance.
    /// `net` is filled with the control points.
    fn new(
        patch: &BezierPatch,
        [least, greatest]: &[DVec3; 2],
        ray: &Ray,
        net: &'a mut PlanePoles,
    ) -> Option<Self> {
        let unit = ray.direction.try_normalize()?;
        let along = unit / ray.direction.length();
        let foot = (0.5 * (*least + *greatest) - ray.origin).dot(along);
        // From a near origin, the coordinates across the ray lose no digits to its length.
        let origin = ray.origin + foot * ray.direction;
        if !(origin.is_finite() && along.is_finite() && (*greatest - *least).is_finite()) {
            return None;
        }
        let (across, beside) = unit.any_orthonormal_pair();
        let mut depths = [f64::INFINITY, f64::NEG_INFINITY];
        let mut weights = [f64::INFINITY, 0.0_f64];
        let mut magnitude = 0.0_f64;
        for pole in &patch.net {
            let from = pole.truncate() - pole.w * origin;
            let depth = foot + from.dot(along) / pole.w;
            depths = [depths[0].min(depth), depths[1].max(depth)];
            weights = [weights[0].min(pole.w), weights[1].max(pole.w)];
            magnitude = magnitude.max(pole.truncate().abs().max_element());
            net.push(DVec2::new(from.dot(across), from.dot(beside)));
        }
        magnitude += weights[1] * origin.abs().max_element();
        // The origin, the products and the patch's own control points are rounded.
        let noise = 8.0 * f64::EPSILON * (magnitude + weights[1] * (ray.origin - origin).abs().max_element());
        let size = (*greatest - *least).length();
        if noise >= weights[0] * size {
            return None;
        }
        let tolerance = (TOUCH * weights[0] * size).max(4.0 * noise);
        let net = PlaneNet { degrees: patch.degrees, net, noise, tolerance };
        Some(Self { net, depths, foot, origin, along, size: size * along.length() })
    }

    /// The distance of a point of the patch.
    fn distance(&self, patch: &BezierPatch, unit: DVec2) -> f64 {
        let DVec4 { x, y, z, w } = patch.homogeneous(unit);
        self.foot + (DVec3::new(x, y, z) / w - self.origin).dot(self.along)
    }
}

#[cfg(test)]
#[path = "meet_tests.rs"]
mod tests;
