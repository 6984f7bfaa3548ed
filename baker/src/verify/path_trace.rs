//! Ground truth of the project: a brute-force path tracer. Independent of points, basis and
//! operator; only the surfaces and the lights are shared code.
//!
//! Paths start at the eye, where back faces of one-sided surfaces are invisible, and continue in
//! cosine-distributed directions; at every surface the lamps are sampled. Paths end by Russian
//! roulette after [`ROULETTE_DEPTH`] bounces.

use crate::geometry::{Ray, Surfaces};
use crate::io::picture::{Only, Picture};
use crate::light::direct;
use crate::random::Stream;
use crate::verify::expose::{Exposure, expose};
use glam::Vec3;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::{Light, LightSource};
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
}

/// Renders `surfaces`; local space is world space − `origin`. `row_done` is called after each row,
/// from any thread.
pub fn path_trace(
    surfaces: &impl Surfaces,
    origin: [f64; 3],
    camera: &Camera,
    lights: &[Light],
    exposure: Exposure,
    settings: Settings,
    row_done: impl Fn() + Sync,
) -> Picture {
    let lights: Vec<LightSource> = lights.iter().map(|l| l.source(origin)).collect();
    let radiance = |ray: &Ray, stream: &mut Stream| radiance(surfaces, &lights, *ray, settings, stream);
    expose(&camera.frame(origin), exposure, radiance, row_done)
}

/// Single-sample estimate of the linear RGB radiance along `ray`, toward its origin.
pub fn radiance(
    surfaces: &impl Surfaces,
    lights: &[LightSource],
    mut ray: Ray,
    settings: Settings,
    stream: &mut Stream,
) -> Vec3 {
    let last = if settings.only == Only::Direct { 0 } else { settings.bounces.unwrap_or(u32::MAX) };
    let mut total = Vec3::ZERO;
    let mut throughput = Vec3::ONE;
    let mut depth = 0;
    let mut next = surfaces.see(&ray, stream.bits() as u32);
    while let Some(hit) = next {
        throughput *= surfaces.tint(&ray, hit.distance, depth == 0);
        if depth == 0 && settings.only == Only::All {
            total += throughput * hit.emission;
        }
        if depth == 0 && hit.is_unlit {
            break;
        }
        throughput *= hit.albedo;
        if throughput == Vec3::ZERO {
            break;
        }
        if depth > 0 || settings.only != Only::Indirect {
            total += throughput * FRAC_1_PI * direct::toward_hit(surfaces, lights, &hit, stream);
        }
        if depth >= last {
            break;
        }
        if depth >= ROULETTE_DEPTH {
            let survival = throughput.max_element().min(MOST_SURVIVAL);
            if stream.unit() >= survival {
                break;
            }
            throughput /= survival;
        }
        let direction = stream.cosine_hemisphere(hit.normal);
        let origin = hit.offset_origin(direction, surfaces.epsilon_at(hit.position));
        ray = Ray { origin, direction, max_distance: f32::INFINITY, spread: 0.0 };
        next = surfaces.cast(&ray, stream.bits() as u32);
        depth += 1;
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::TriangleSurfaces;

    #[test]
    fn a_closed_room_of_albedo_half_holds_as_much_bounced_light_as_direct() {
        // Flux: the walls receive 4π·I from the lamp; each bounce keeps half. On average over the
        // walls the indirect irradiance is ρ/(1 − ρ) = 1 times the direct irradiance, 4π·I / 24.
        let room = crate::io::load("builtin:furnace").unwrap();
        let surfaces = TriangleSurfaces::from_scene(&room);
        let lights = [room.lights[0].source(room.origin)];
        let n = 200_000;
        let (mut direct, mut indirect) = (0.0, 0.0);
        for i in 0..n {
            let mut stream = Stream::new(1, i);
            let axis = (i % 3) as usize;
            let at = stream.square() * 2.0 - 1.0;
            let mut origin = [0.0; 3];
            (origin[(axis + 1) % 3], origin[(axis + 2) % 3]) = (at.x, at.y);
            let mut direction = Vec3::ZERO;
            direction[axis] = if stream.unit() < 0.5 { 1.0 } else { -1.0 };
            let ray = Ray { origin: origin.into(), direction, max_distance: f32::INFINITY, spread: 0.0 };
            let mut of =
                |only| radiance(&surfaces, &lights, ray, Settings { only, bounces: None }, &mut stream).x;
            direct += of(Only::Direct) as f64;
            indirect += of(Only::Indirect) as f64;
        }
        // Radiance = albedo / π · irradiance.
        let expected = 0.5 / std::f64::consts::PI * 4.0 * std::f64::consts::PI / 24.0;
        assert!(
            (direct / n as f64 / expected - 1.0).abs() < 0.005,
            "direct {}",
            direct / n as f64 / expected
        );
        assert!(
            (indirect / n as f64 / expected - 1.0).abs() < 0.01,
            "indirect {}",
            indirect / n as f64 / expected
        );
    }

    #[test]
    fn bounces_add_up_as_a_geometric_series() {
        let room = crate::io::load("builtin:furnace").unwrap();
        let surfaces = TriangleSurfaces::from_scene(&room);
        let exposure = Exposure { size: [24, 24], samples: 64, seed: 3 };
        let mean = |bounces| {
            let settings = Settings { only: Only::Indirect, bounces };
            let picture =
                path_trace(&surfaces, room.origin, &room.cameras[0], &room.lights, exposure, settings, || ());
            picture.pixels.iter().map(|p| p.x).sum::<f32>() / picture.pixels.len() as f32
        };
        let (one, all) = (mean(Some(1)), mean(None));
        assert_eq!(mean(Some(0)), 0.0);
        // Almost uniform after the first bounce: each further bounce has half the irradiance of the
        // previous bounce.
        assert!((all / one - 2.0).abs() < 0.06, "{}", all / one);
    }

    #[test]
    fn no_path_of_a_white_room_outweighs_the_others() {
        // Path lengths are random and bounces about equally bright: the light of a path varies
        // about as its length, whose standard deviation is its mean. Termination more frequent than
        // the loss of light would make surviving paths far brighter.
        let mut room = crate::io::load("builtin:furnace").unwrap();
        room.materials.iter_mut().for_each(|material| material.base_color = [0.97, 0.97, 0.97, 1.0]);
        let surfaces = TriangleSurfaces::from_scene(&room);
        let lights = [room.lights[0].source(room.origin)];
        let settings = Settings { only: Only::Indirect, bounces: None };
        let paths: Vec<f64> = (0..20_000)
            .map(|i| {
                let ray =
                    Ray { origin: Vec3::ZERO, direction: Vec3::Y, max_distance: f32::INFINITY, spread: 0.0 };
                radiance(&surfaces, &lights, ray, settings, &mut Stream::new(1, i)).x.into()
            })
            .collect();
        let mean = paths.iter().sum::<f64>() / paths.len() as f64;
        let squares = paths.iter().map(|path| (path - mean).powi(2)).sum::<f64>() / paths.len() as f64;
        assert!(squares.sqrt() < 1.2 * mean, "{} of {mean}", squares.sqrt());
        assert!(paths.iter().all(|path| *path < 30.0 * mean));
    }

    #[test]
    fn the_parts_sum_to_the_whole_at_any_thread_count() {
        let room = crate::io::load("builtin:cornell-box").unwrap();
        let surfaces = TriangleSurfaces::from_scene(&room);
        let exposure = Exposure { size: [16, 16], samples: 8, seed: 5 };
        let take = |only, threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let settings = Settings { only, bounces: None };
            pool.install(|| {
                path_trace(&surfaces, room.origin, &room.cameras[0], &room.lights, exposure, settings, || ())
            })
        };
        let all = take(Only::All, 1);
        assert_eq!(all, take(Only::All, 3));
        let (direct, indirect) = (take(Only::Direct, 2), take(Only::Indirect, 2));
        assert!(indirect.pixels.iter().any(|p| p.x > 0.0));
        for ((a, d), i) in all.pixels.iter().zip(&direct.pixels).zip(&indirect.pixels) {
            assert!((*a - *d - *i).abs().max_element() <= 1e-5 * (1.0 + a.max_element()));
        }
    }
}
