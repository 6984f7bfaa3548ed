//! The rays of one receiver's gather, in the order that they are cast.

use super::directions::Directions;
use crate::points::SurfacePoint;
use crate::random::mix;
use crate::surface::Ray;
use glam::Vec3;

/// The rays of some gathers, one after the other.
#[derive(Clone, Debug, Default)]
pub struct GatherRays {
    /// What is cast, and what decides on what transparent surfaces do.
    pub rays: Vec<(Ray, u32)>,
    /// What each ray counts: cosine times weight, over the sum of that over all directions.
    pub shares: Vec<f32>,
}

impl GatherRays {
    /// Takes all rays out.
    pub fn clear(&mut self) {
        self.rays.clear();
        self.shares.clear();
    }
}

/// Adds the rays of a receiver to `out`: those of `directions` around its shading normal that leave its true
/// surface. `epsilon` is [`Surfaces::epsilon`](crate::surface::Surfaces::epsilon). A closed white room's shares sum to 1.
pub fn gather_rays(
    point: &SurfacePoint,
    receiver: usize,
    seed: u64,
    epsilon: f32,
    directions: &Directions,
    out: &mut GatherRays,
) {
    let origin = point.position + point.geometric_normal * epsilon;
    let name = mix(seed) ^ (receiver as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let first = out.shares.len();
    // The square root of the solid angle that each stands for.
    let spread = (std::f32::consts::TAU / directions.len() as f32).sqrt();
    let mut total = 0.0;
    for (i, d) in directions.around(point.normal, receiver, seed).enumerate() {
        let share = d.cosine * d.weight;
        total += share;
        let direction = Vec3::from(d.direction);
        if direction.dot(point.geometric_normal) > 0.0 {
            let ray = Ray { origin, direction, max_distance: f32::INFINITY, spread };
            out.rays.push((ray, mix(name ^ i as u64) as u32));
            out.shares.push(share);
        }
    }
    // Dividing by this sum instead of the number of rays makes a closed white room exact.
    out.shares[first..].iter_mut().for_each(|share| *share /= total);
}
