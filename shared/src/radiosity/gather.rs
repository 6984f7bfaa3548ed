//! Gather: irradiance of a receiver as the mean over rays of the light that is sent towards it (the 2011 paper, 4.1). Twin of
//! `gather_light.wgsl`.

use super::accelerator::{Accelerator, PlacedModels};
use super::directions::{direction, hash, shift, square};
use super::reconstruction::{HitPoint, Reconstruction, Senders};
use super::traversal::{Ray, nearest};
use crate::footprint::LIFT;
use glam::Vec3;

/// Irradiance of a receiver.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Gathered {
    /// Linear RGB.
    pub irradiance: Vec3,
    /// Variance of the mean of its channels, as if rays were random.
    pub variance: f32,
}

/// Inputs of all gathers of a pass.
#[derive(Clone, Copy, Debug)]
pub struct Gather<'a> {
    /// BVHs of the models.
    pub accelerator: &'a Accelerator,
    /// Models at their places.
    pub placed: &'a PlacedModels,
    /// Points, as senders and as receivers.
    pub senders: Senders<'a>,
    /// Support radius of the finest level, scene units.
    pub finest_radius: f32,
    /// How light at hits is taken from the points.
    pub reconstruction: Reconstruction,
    /// Rays of a receiver.
    pub rays: u32,
    /// Number of the pass: directions differ.
    pub pass: u32,
}

impl Gather<'_> {
    /// Gathers for a point; `light` is the light that each point sends: albedo times unshot irradiance.
    pub fn irradiance(&self, receiver: u32, light: &[Vec3]) -> Gathered {
        let point = &self.senders.points[receiver as usize];
        let normal = point.normal();
        let origin = point.position() + normal * (LIFT * point.radius.min(self.finest_radius));
        let shift = shift(receiver, self.pass);
        let (mut sum, mut squares) = (Vec3::ZERO, 0.0);
        for k in 0..self.rays {
            let ray = Ray {
                origin,
                direction: direction(square(k, self.rays, shift), normal),
                seed: hash(receiver ^ hash(k ^ hash(self.pass))),
            };
            let light = self.sent(&ray, light);
            sum += light;
            squares += (light.element_sum() / 3.0).powi(2);
        }
        let rays = self.rays as f32;
        let mean = sum / rays;
        let variance = (squares / rays - (mean.element_sum() / 3.0).powi(2)).max(0.0) / rays;
        Gathered { irradiance: mean, variance }
    }

    /// The light that the nearest surface sends back along a ray, times π.
    fn sent(&self, ray: &Ray, light: &[Vec3]) -> Vec3 {
        let Some(hit) = nearest(self.accelerator, self.placed, ray).filter(|hit| !hit.is_dark) else {
            return Vec3::ZERO;
        };
        let place = HitPoint {
            position: ray.origin + hit.distance * ray.direction,
            normal: hit.normal,
            group: self.accelerator.triangles[hit.triangle as usize].group,
            rest_from_local: self.placed.models[hit.model as usize].rest_from_local(),
        };
        self.senders.light(&place, self.reconstruction, light)
    }
}
