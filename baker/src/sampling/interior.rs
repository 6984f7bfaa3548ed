//! Interior of an object: the sides of its surface that nothing but the object itself can see.
//!
//! Exporters often call closed bodies two-sided. A plate's underside, seen from within the plate, faces up as its top does, and
//! lies millimetres below: points there would darken the light of the top. A side is interior if hardly a ray that leaves it
//! passes the object. Other groups do not count as obstacles: they may move away.

use super::object_side::{ObjectSide, place};
use crate::geometry::{Primitives, Ray, Surfaces};
use crate::random::Stream;
use glam::Vec3;
use rayon::prelude::*;

/// Rays of a side smaller than a disk, and at most: a hole in a small side's neighbourhood is found from the others.
const RAYS: [u32; 2] = [16, 128];
/// One in so many rays may leave the interior: through the open end of a handle.
const LEAVING: u32 = 32;
/// Surfaces of other groups that a ray passes; beyond, it has passed the object.
const MOST_PASSED: u32 = 16;
/// Rays from a viewpoint.
const FROM_VIEWPOINT: u32 = 64;

/// Test of an object's sides.
pub(super) struct Interior<'a, S: ?Sized> {
    /// Whole scene.
    pub surfaces: &'a S,
    /// Its primitives.
    pub primitives: &'a dyn Primitives,
    /// Reconstruction group of the object.
    pub group: u32,
    /// Diagonal of the object, scene units.
    pub reach: f32,
    /// Disk radius of the finest level on the object, scene units.
    pub disk: f32,
    /// Seed of all random numbers.
    pub seed: u64,
}

impl<S: Surfaces + ?Sized> Interior<'_, S> {
    /// Returns the sides that are not interior; all of them if a viewpoint is within the object.
    pub fn without(&self, sides: Vec<ObjectSide>, viewpoints: &[Vec3]) -> Vec<ObjectSide> {
        if viewpoints.iter().any(|viewpoint| self.holds(*viewpoint)) {
            return sides;
        }
        sides.into_par_iter().filter(|side| !self.has(side)).collect()
    }

    /// Whether a side is interior.
    fn has(&self, side: &ObjectSide) -> bool {
        let number = u64::from(side.primitive) << 1 | u64::from(side.is_back);
        let mut stream = Stream::new(self.seed ^ 0x696e_7465, number);
        let disks = side.area / (self.disk * self.disk).max(f32::MIN_POSITIVE);
        let rays = ((RAYS[0] as f32 * disks) as u32).clamp(RAYS[0], RAYS[1]);
        let mut left = rays / LEAVING;
        (0..rays).all(|_| {
            let (spot, normal) = place(self.primitives, side, &mut stream);
            let origin = spot.position + normal * self.surfaces.epsilon_at(spot.position);
            let direction = stream.cosine_hemisphere(normal);
            self.meets(origin, direction, &mut stream) || {
                let may_leave = left > 0;
                left = left.saturating_sub(1);
                may_leave
            }
        })
    }

    /// Whether the object is all around a place.
    fn holds(&self, place: Vec3) -> bool {
        let mut stream = Stream::new(self.seed ^ 0x686f_6c64, u64::from(self.group));
        (0..FROM_VIEWPOINT).all(|_| {
            let direction = stream.sphere();
            self.meets(place, direction, &mut stream)
        })
    }

    /// Whether a ray meets the object.
    fn meets(&self, origin: Vec3, direction: Vec3, stream: &mut Stream) -> bool {
        let ray = Ray { origin, direction, max_distance: self.reach, spread: Ray::VISIBILITY };
        self.surfaces.cast_group(ray, self.group, MOST_PASSED, stream.bits() as u32).is_some()
    }
}
