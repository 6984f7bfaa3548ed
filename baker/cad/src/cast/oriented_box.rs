//! Boxes about pieces of splines that lie as the piece does: flat pieces have thin ones.

use crate::spline::BezierPatch;
use crate::surface::Ray;
use glam::{DMat3, DVec3};

/// How far a box is larger than what it holds, which rounding alone needs: in multiples of its size, and of the coordinates of a
/// ray's origin.
pub(super) const MARGIN: f64 = 1e-6;
pub(super) const ROUNDING: f64 = 1e-12;

/// A box with axes of its own.
#[derive(Clone, Copy, Debug)]
pub(super) struct OrientedBox {
    /// Rows are the axes, unit vectors at right angles.
    box_from_space: DMat3,
    middle: DVec3,
    half: DVec3,
}

impl OrientedBox {
    /// A box about a patch's control points: one axis is normal to the patch in the middle.
    pub fn of(patch: &BezierPatch) -> Self {
        let place = |index: usize| patch.pole(index);
        let last = patch.net.len() - 1;
        let corners = [place(0), place(patch.degrees[1]), place(last - patch.degrees[1]), place(last)];
        let [along_u, along_v] = [
            corners[2] + corners[3] - corners[0] - corners[1],
            corners[1] + corners[3] - corners[0] - corners[2],
        ];
        let normal = along_u.cross(along_v).try_normalize();
        let longer = if along_u.length_squared() >= along_v.length_squared() { along_u } else { along_v };
        let axes = normal.and_then(|normal| Some((longer.try_normalize()?, normal)));
        let axes = axes.map_or(DMat3::IDENTITY, |(x, z)| DMat3::from_cols(x, z.cross(x), z));
        let box_from_space = axes.transpose();
        let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [low, high] = (0..=last).fold(empty, |[low, high], index| {
            let at = box_from_space * place(index);
            [low.min(at), high.max(at)]
        });
        let half = 0.5 * (high - low);
        let half = half + MARGIN * half.max_element();
        Self { box_from_space, middle: 0.5 * (low + high), half }
    }

    /// Whether a ray may come to what is in the box, at distances from the first to the second.
    pub fn may_meet(&self, ray: &Ray, distances: [f64; 2]) -> bool {
        let origin = self.box_from_space * ray.origin - self.middle;
        let direction = self.box_from_space * ray.direction;
        let half = self.half + ROUNDING * ray.origin.abs().max_element();
        let inverse = 1.0 / direction;
        let [a, b] = [(-half - origin) * inverse, (half - origin) * inverse];
        // 0 · ∞ is no number, and neither least nor greatest then.
        let near = a.min(b).to_array().into_iter().fold(distances[0], f64::max);
        let far = a.max(b).to_array().into_iter().fold(distances[1], f64::min);
        // Distances are rounded in proportion to their size.
        near <= far + ROUNDING * far.abs() || !(near <= f64::INFINITY && far >= f64::NEG_INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix;
    use crate::spline::patches;
    use crate::spline::samples::{sphere, wavy};
    use glam::DVec2;

    #[test]
    fn rays_to_points_of_a_patch_come_to_its_box_and_few_others_do() {
        let mut random = SplitMix(21);
        for patch in patches(&wavy(6)).into_iter().chain(patches(&sphere(1.5))) {
            let patch = patch.halves(0)[0].halves(1)[1].clone();
            let around = OrientedBox::of(&patch);
            for _ in 0..500 {
                let unit = DVec2::new(random.between(0.0, 1.0), random.between(0.0, 1.0));
                let place = patch.point(unit);
                let origin = place + random.between(0.1, 100.0) * random.direction();
                let ray = Ray { origin, direction: place - origin };
                assert!(around.may_meet(&ray, [0.0, 1.0]));
                assert!(!around.may_meet(&ray, [1e4, f64::INFINITY]));
                let aside = Ray { direction: ray.direction.any_orthogonal_vector(), ..ray };
                let size = ray.direction.length();
                assert!(size < 9.0 || !around.may_meet(&aside, [0.0, f64::INFINITY]));
            }
        }
    }

    #[test]
    fn rays_along_an_axis_in_a_side_of_a_flat_box_come_to_it() {
        let net = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
        let net = net.map(|[x, y]| DVec3::new(x, y, 2.0).extend(1.0)).to_vec();
        let patch = BezierPatch { degrees: [1, 1], net, range: [DVec2::ZERO, DVec2::ONE] };
        let around = OrientedBox::of(&patch);
        for y in [0.0, 0.5, 1.0] {
            let ray = Ray { origin: DVec3::new(-1.0, y, 2.0), direction: DVec3::X };
            assert!(around.may_meet(&ray, [0.0, f64::INFINITY]));
            assert!(!around.may_meet(&Ray { direction: DVec3::Z, ..ray }, [0.0, f64::INFINITY]));
        }
    }
}
