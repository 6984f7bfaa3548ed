//! Ground truth of the project: a brute-force path tracer. Independent of points, basis and
//! operator; only the surfaces and the lights are shared code.
//!
//! Paths start at the eye, where back faces of one-sided surfaces are invisible, and continue in
//! directions that the surface's [`Bsdf`] samples; at every surface all that shines is sampled, and what
//! shines at the end of a ray counts as well: [`Illumination`] has the weights. Paths end by Russian
//! roulette after [`ROULETTE_DEPTH`] bounces.

use crate::geometry::with_lights::WithLights;
use crate::geometry::{Ray, Surfaces};
use crate::io::picture::{Only, Picture};
use crate::light::bsdf::{Bsdf, BsdfSample};
use crate::light::illumination::Illumination;
use crate::random::Stream;
use crate::verify::expose::{Exposure, expose};
use glam::Vec3;
use rebounce_shared::camera::Camera;
use std::f32::consts::FRAC_1_PI;

/// Number of bounces before Russian roulette starts.
const ROULETTE_DEPTH: u32 = 12;
/// Maximum survival probability of Russian roulette, so that paths in a closed white room end. With
/// nearly white surfaces, a smaller maximum would concentrate most of the light in a few paths:
/// noise of infinite variance.
const MOST_SURVIVAL: f32 = 0.996;

/// Light paths to include.
#[derive(Clone, Copy, Debug, Default)]
pub struct Settings {
    /// Components of light to show.
    pub only: Only,
    /// Maximum number of bounces before the visible surface; unlimited when absent.
    pub bounces: Option<u32>,
    /// Whether metals are GGX conductors; otherwise they are Lambertian.
    pub gloss: bool,
}

/// Renders `surfaces` and the area lights among them; local space is world space − `origin`. `row_done` is called after
/// each row, from any thread.
pub fn path_trace(
    surfaces: &impl Surfaces,
    origin: [f64; 3],
    camera: &Camera,
    illumination: &Illumination,
    exposure: Exposure,
    settings: Settings,
    row_done: impl Fn() + Sync,
) -> Picture {
    let surfaces = WithLights::new(surfaces, illumination.areas());
    let radiance = |ray: &Ray, stream: &mut Stream| radiance(&surfaces, illumination, *ray, settings, stream);
    expose(&camera.frame(origin), exposure, radiance, row_done)
}

/// Single-sample estimate of the linear RGB radiance along `ray`, toward its origin. `surfaces` include the area lights:
/// [`WithLights`].
pub fn radiance(
    surfaces: &impl Surfaces,
    illumination: &Illumination,
    mut ray: Ray,
    settings: Settings,
    stream: &mut Stream,
) -> Vec3 {
    let last = if settings.only == Only::Direct { 0 } else { settings.bounces.unwrap_or(u32::MAX) };
    // Light that arrives at the eye or the first surface is direct.
    let counts = |bounces: u32| match settings.only {
        Only::All => true,
        Only::Direct => bounces == 0,
        Only::Indirect => bounces > 0,
    };
    let mut total = Vec3::ZERO;
    let mut throughput = Vec3::ONE;
    // Surfaces before the ray, the last of them, and the density of the ray's direction there, per steradian.
    let mut depth = 0u32;
    let mut before: Option<(Vec3, f32)> = None;
    loop {
        let seed = stream.bits() as u32;
        let hit = if depth == 0 { surfaces.see(&ray, seed) } else { surfaces.cast(&ray, seed) };
        let distance = hit.map_or(f32::INFINITY, |hit| hit.distance);
        throughput *= surfaces.tint(&ray, distance, depth == 0);
        let (emitted, density) = match (&hit, before) {
            (None, _) => illumination.environment(ray.direction),
            // An unlit surface shows its colour and shines on nothing.
            (Some(hit), None) if hit.is_unlit => match settings.only {
                Only::All => (hit.emission, 0.0),
                Only::Direct | Only::Indirect => (Vec3::ZERO, 0.0),
            },
            (Some(hit), Some(_)) if hit.is_unlit => (Vec3::ZERO, 0.0),
            (Some(hit), before) => illumination.emitted(hit, before.map_or(ray.origin, |(from, _)| from)),
        };
        if emitted != Vec3::ZERO && counts(depth.saturating_sub(1)) {
            let weight = before.map_or(1.0, |(_, own)| own / (own + density));
            total += throughput * emitted * weight;
        }
        let Some(hit) = hit.filter(|hit| depth <= last && !(depth == 0 && hit.is_unlit)) else { break };
        let bsdf = Bsdf::new(&hit, -ray.direction, settings.gloss);
        throughput *= bsdf.albedo;
        if throughput == Vec3::ZERO {
            break;
        }
        // A stream of its own: paths are the same whichever light counts, so that direct and bounced light add up.
        let own = stream.bits();
        if counts(depth) {
            let mut own = Stream::new(own, depth.into());
            total += throughput * FRAC_1_PI * illumination.estimate(surfaces, &hit, &bsdf, &mut own);
        }
        if depth == last && !(counts(depth) && illumination.is_met_by_chance()) {
            break;
        }
        if depth >= ROULETTE_DEPTH {
            let survival = throughput.max_element().min(MOST_SURVIVAL);
            if stream.unit() >= survival {
                break;
            }
            throughput /= survival;
        }
        let Some(BsdfSample { to_light: direction, weight, density }) = bsdf.sample(stream) else { break };
        throughput *= weight;
        let origin = hit.offset_origin(direction, surfaces.epsilon_at(hit.position));
        ray = Ray { origin, direction, max_distance: f32::INFINITY, spread: 0.0 };
        before = Some((hit.position, density));
        depth += 1;
    }
    total
}

#[cfg(test)]
mod tests;
