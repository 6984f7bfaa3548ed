//! What a metal that a ray meets sends back: one more gather, over its own lobe.
//!
//! Transport between points takes metals for Lambertian. Seen in another metal such a neighbour would look like chalk, so a ray
//! that meets one goes on by samples of its GGX lobe: what leaves the scene has the environment's functions, what meets a
//! surface once more has its diffuse light.

use super::sky_irradiance::SkyIrradiance;
use crate::geometry::{Hit, Ray, Surfaces};
use crate::light::bsdf::Bsdf;
use crate::random::{Stream, mix};
use glam::Vec3;
use rebounce_shared::harmonics::{COUNT, evaluate};

/// Samples of a lobe.
const SAMPLES: u32 = 4;
/// Random numbers of lobes: the same for a direction at all points, as the directions are.
const SEED: u64 = 0x6c6f_6265;

/// Light that hits send back along rays.
pub(super) struct Neighbours<'a, S: ?Sized> {
    pub surfaces: &'a S,
    /// Roughness from which metals are Lambertian.
    pub metals: f32,
}

impl<S: Surfaces + ?Sized> Neighbours<'_, S> {
    /// Radiance that a hit sends back along the ray with this direction and number, by function of the environment; and the
    /// number of rays. `weights` is room to work in.
    pub fn radiance(
        &self,
        irradiance: &SkyIrradiance,
        hit: &Hit,
        (direction, number): (Vec3, usize),
        weights: &mut Vec<(u32, f32)>,
    ) -> ([Vec3; COUNT], u64) {
        if !(hit.gloss.is_metal() && hit.gloss.roughness < self.metals) {
            return (irradiance.radiance(hit, weights), 0);
        }
        let bsdf = Bsdf::new(hit, -direction, true);
        let mut stream = Stream::new(SEED, number as u64);
        let mut sums = [Vec3::ZERO; COUNT];
        let epsilon = self.surfaces.epsilon_at(hit.position);
        for _ in 0..SAMPLES {
            let Some(sample) = bsdf.sample(&mut stream) else { continue };
            let origin = hit.offset_origin(sample.to_light, epsilon);
            let ray = Ray { origin, direction: sample.to_light, max_distance: f32::INFINITY, spread: 0.05 };
            let weight = bsdf.albedo * (sample.weight / SAMPLES as f32);
            match self.surfaces.cast(&ray, mix(stream.bits()) as u32) {
                Some(next) => {
                    let sent = irradiance.radiance(&next, weights);
                    sums.iter_mut().zip(sent).for_each(|(sum, sent)| *sum += weight * sent);
                }
                None => {
                    let open = evaluate(sample.to_light);
                    sums.iter_mut().zip(open).for_each(|(sum, y)| *sum += weight * y);
                }
            }
        }
        (sums, SAMPLES.into())
    }
}
