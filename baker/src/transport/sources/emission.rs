//! Irradiance from the groups of emissive surfaces at a receiver: next-event estimation over the emissive triangles, by
//! solid angle, with visibility rays.

use super::emitter_tree::{Assigned, EmitterTree};
use super::triangle_sampling::SphericalTriangle;
use crate::geometry::{Emitters, Surfaces};
use crate::random::{Stream, mix};
use crate::sampling::SurfacePoint;
use glam::{Vec2, Vec3};
use std::f32::consts::TAU;

/// Share of the distance to a sample that its visibility ray leaves out, so that the emitter does not hide itself.
const SHORTER: f32 = 1e-3;

/// Irradiance from one group, linear RGB, and the variance of its estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GroupSeen {
    /// Irradiance.
    pub irradiance: Vec3,
    /// Variance of the irradiance, estimated from the samples.
    pub variance: Vec3,
}

/// Emissive triangles with their groups.
pub struct Emission<'a> {
    emitters: &'a dyn Emitters,
    tree: EmitterTree,
    /// Group of each material; `None` without emission.
    group_of: Vec<Option<u32>>,
}

impl<'a> Emission<'a> {
    /// Prepares emitters; `group_of` has the group of each material.
    pub fn new(emitters: &'a dyn Emitters, group_of: Vec<Option<u32>>) -> Self {
        Self { emitters, tree: EmitterTree::new(emitters), group_of }
    }

    /// Estimates the irradiance of a receiver from each group, with `samples` visibility rays in all; returns the number
    /// of rays.
    pub fn see<S: Surfaces + ?Sized>(
        &self,
        surfaces: &S,
        (point, receiver): (&SurfacePoint, usize),
        samples: u32,
        seed: u64,
        assigned: &mut Vec<Assigned>,
        out: &mut [GroupSeen],
    ) -> u64 {
        out.fill(GroupSeen::default());
        let mut stream = Stream::new(mix(seed) ^ 0x656d_6974, receiver as u64);
        let origin = point.position + point.geometric_normal * surfaces.epsilon_at(point.position);
        self.tree.assign(point.position, point.normal, samples, &mut stream, assigned);
        let mut rays = 0;
        for &Assigned { emitter, samples, expected } in assigned.iter() {
            let triangle = self.emitters.emitter(emitter);
            let Some(group) = self.group_of.get(triangle.material as usize).copied().flatten() else {
                continue;
            };
            let Some(spherical) = SphericalTriangle::new(triangle.corners, point.position) else { continue };
            let from_front = triangle.front().dot(point.position - triangle.corners[0]) > 0.0;
            if !triangle.is_two_sided && !from_front {
                continue;
            }
            let (turn, mut sum, mut squares) = (stream.unit(), Vec3::ZERO, Vec3::ZERO);
            for k in 0..samples {
                // The first coordinate is stratified over the triangle's samples.
                let square =
                    Vec2::new((k as f32 + stream.unit()) / samples as f32, (turn + stream.unit()).fract());
                let Some(sample) = spherical.sample(square) else { continue };
                let cosine = point.normal.dot(sample.direction);
                if cosine <= 0.0 || point.geometric_normal.dot(sample.direction) <= 0.0 {
                    continue;
                }
                rays += 1;
                let end = sample.position.lerp(origin, SHORTER);
                let through = surfaces.transmittance(origin, end);
                if through == Vec3::ZERO {
                    continue;
                }
                let weights = [1.0 - sample.at.element_sum(), sample.at.x, sample.at.y];
                let radiance = self.emitters.radiance(emitter, weights, sample.direction);
                let amount = radiance * through * (cosine * sample.solid_angle.min(TAU));
                sum += amount;
                squares += amount * amount;
            }
            let found = &mut out[group as usize];
            found.irradiance += sum / expected;
            // Variance of a sum of independent samples.
            let spread = (squares - sum * sum / samples as f32).max(Vec3::ZERO);
            found.variance += spread / (expected * expected);
        }
        rays
    }
}
