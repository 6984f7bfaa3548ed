//! A baked scene whose groups have moved.

use super::BakedScene;
use crate::motion::Motions;
use crate::octahedral::pack_snorm16;
use crate::rbn::bulk::{Instance, Point};
use glam::Vec3;

impl BakedScene {
    /// Returns the instances of a scene whose groups have moved.
    pub fn moved_instances(&self, motions: &Motions) -> Vec<Instance> {
        let mut out = self.instances.clone();
        if motions.is_empty() {
            return out;
        }
        let mut is_done = vec![false; out.len()];
        for (i, draw) in self.meta.draws.iter().enumerate() {
            let motion = motions.of(self.groups.of_material(draw.material));
            for copy in self.copies_of(i).filter(|_| motion.is_moved()) {
                if !std::mem::replace(&mut is_done[copy], true) {
                    let place = motion.local_from_rest * out[copy].local_from_model();
                    out[copy] = Instance::from(&place);
                }
            }
        }
        out
    }

    /// Returns point `i` where its group is.
    pub fn moved_point(&self, i: usize, motions: &Motions) -> Point {
        let (point, motion) = (self.points[i], motions.of(self.group_of(i)));
        if !motion.is_moved() {
            return point;
        }
        let normal = Vec3::from(motion.local_from_rest.matrix3 * glam::Vec3A::from(point.normal()));
        Point {
            position: motion.local_from_rest.transform_point3(point.position()).to_array(),
            normal: pack_snorm16(normal),
            ..point
        }
    }
}
