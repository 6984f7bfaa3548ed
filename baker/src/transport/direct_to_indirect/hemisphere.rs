//! Gather rays of a receiver's hemisphere, in the order of the directions.

use super::directions::Directions;
use super::ray_sort::cells;
use crate::geometry::Ray;
use crate::lanes::{F32x8, LaneKernel, dispatch};
use crate::random::mix;
use crate::sampling::SurfacePoint;
use glam::Vec3;

/// Gather rays of several receivers, receiver after receiver.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GatherRays {
    /// Rays, each with the random seed for transparent surfaces.
    pub rays: Vec<(Ray, u32)>,
    /// Share of each ray in the irradiance: cosine times weight, over the sum of cosine times
    /// weight over all directions.
    pub shares: Vec<f32>,
    /// Direction [cell](super::ray_sort) of each ray.
    pub cells: Vec<u16>,
}

impl GatherRays {
    /// Removes all rays.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.shares.clear();
        self.cells.clear();
    }
}

/// Appends the rays of a receiver to `out`: `directions` around the shading normal, without
/// directions below the geometric surface. `epsilon` is the distance of ray origins from the
/// surface, as in [`Surfaces::epsilon`](crate::geometry::Surfaces::epsilon). In a closed white room
/// the shares sum to 1.
pub fn gather_rays(
    point: &SurfacePoint,
    receiver: usize,
    seed: u64,
    epsilon: f32,
    directions: &Directions,
    out: &mut GatherRays,
) {
    dispatch((HemisphereRays { point, receiver, seed, epsilon, directions }, out));
}

/// Arguments of [`gather_rays`].
struct HemisphereRays<'a> {
    point: &'a SurfacePoint,
    receiver: usize,
    seed: u64,
    epsilon: f32,
    directions: &'a Directions,
}

impl LaneKernel for (HemisphereRays<'_>, &mut GatherRays) {
    type Output = ();

    #[inline(always)]
    fn run<V: F32x8>(self) {
        self.0.rays(self.1);
    }
}

impl HemisphereRays<'_> {
    #[inline(always)]
    fn rays(&self, out: &mut GatherRays) {
        let Self { point, directions, .. } = *self;
        let origin = point.position + point.geometric_normal * self.epsilon;
        let name = mix(self.seed) ^ (self.receiver as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let first = out.shares.len();
        // Square root of the solid angle of a ray.
        let spread = (std::f32::consts::TAU / directions.len() as f32).sqrt();
        let mut total = 0.0;
        let mut number = 0;
        for block in directions.blocks(point.normal, self.receiver, self.seed) {
            let [x, y, z] = block.direction;
            let cells = cells(&block.direction);
            for i in 0..block.len {
                let (direction, share) = (Vec3::new(x[i], y[i], z[i]), block.share[i]);
                total += share;
                if direction.dot(point.geometric_normal) > 0.0 {
                    let ray = Ray { origin, direction, max_distance: f32::INFINITY, spread };
                    out.rays.push((ray, mix(name ^ number) as u32));
                    out.shares.push(share);
                    out.cells.push(cells[i]);
                }
                number += 1;
            }
        }
        // Normalising by this sum instead of the number of rays makes a closed white room exact.
        out.shares[first..].iter_mut().for_each(|share| *share /= total);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    /// A bake is byte-identical on every processor.
    #[test]
    fn rays_do_not_depend_on_how_many_are_made_at_a_time() {
        let mut stream = Stream::new(3, 3);
        for (receiver, count) in [1, 5, 8, 250, 512, 4096].into_iter().enumerate() {
            let directions = Directions::new(count);
            let (normal, geometric_normal) = (stream.sphere(), stream.sphere());
            let point = SurfacePoint { position: stream.sphere(), normal, geometric_normal, group: 0 };
            let (mut told, mut plain) = (GatherRays::default(), GatherRays::default());
            gather_rays(&point, receiver, 7, 0.01, &directions, &mut told);
            let point = &point;
            HemisphereRays { point, receiver, seed: 7, epsilon: 0.01, directions: &directions }
                .rays(&mut plain);
            assert_eq!(told, plain);
            assert!(told.rays.len() <= count as usize && (count < 8 || !told.rays.is_empty()));
        }
    }
}
