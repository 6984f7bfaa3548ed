//! Light of a surface that is seen in a reflection: the irradiance of a picture's own surfaces, and what shines.

use super::Reflections;
use crate::geometry::{Hit, HitEmitter, Ray, Surfaces};
use crate::io::picture::Only;
use crate::random::Stream;
use crate::verify::render::Relit;
use glam::Vec3;
use std::f32::consts::FRAC_1_PI;

impl Reflections {
    /// Radiance that a surface sends against a ray in `direction`, without that of lamps, which metals reflect by themselves.
    /// Metals reflect by the transfer.
    pub(super) fn seen(
        &self,
        relit: &Relit,
        surfaces: &impl Surfaces,
        hit: &Hit,
        direction: Vec3,
        stream: &mut Stream,
    ) -> Vec3 {
        if hit.is_unlit {
            return Vec3::ZERO;
        }
        let emission = match hit.emitter {
            Some(HitEmitter::Light(_)) => Vec3::ZERO,
            _ => relit.emission(surfaces, hit),
        };
        if hit.albedo == Vec3::ZERO {
            return emission;
        }
        let is_metal = hit.gloss.is_metal();
        let conducted = is_metal.then(|| self.by_transfer(&relit.lighting, &relit.basis, hit, direction));
        emission
            + match conducted.flatten() {
                Some(around) => around + relit.lamps_on_metal(surfaces, hit, direction, stream),
                None => hit.albedo * FRAC_1_PI * relit.irradiance(surfaces, hit, Only::All, stream),
            }
    }

    /// Radiance that arrives at a hit from a direction, by a ray; `sky` if the ray leaves the scene.
    pub(super) fn along_ray(
        &self,
        relit: &Relit,
        surfaces: &impl Surfaces,
        hit: &Hit,
        direction: Vec3,
        sky: impl FnOnce() -> Vec3,
        stream: &mut Stream,
    ) -> Vec3 {
        let origin = hit.offset_origin(direction, surfaces.epsilon_at(hit.position));
        let ray = Ray { origin, direction, max_distance: f32::INFINITY, spread: 0.0 };
        let found = surfaces.cast(&ray, stream.bits() as u32);
        let distance = found.map_or(f32::INFINITY, |found| found.distance);
        let radiance = match &found {
            None => sky(),
            Some(found) => self.seen(relit, surfaces, found, direction, stream),
        };
        radiance * surfaces.tint(&ray, distance, false)
    }
}
