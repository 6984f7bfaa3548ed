//! Level of a scene's direct light, independent of the view: input of the exposure of PNGs.

use super::direct;
use crate::geometry::{Ray, Surfaces};
use crate::random::Stream;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::colour::luminance;
use rebounce_shared::exposure;
use rebounce_shared::light::LightSource;

/// Number of rays, with random origins in the scene and random directions.
const RAYS: u64 = 1 << 14;

/// [Level](exposure::level) of direct light at front-facing hits of rays through the whole scene.
pub fn level(surfaces: &(impl Surfaces + ?Sized), lights: &[LightSource]) -> f32 {
    let (low, high) = surfaces.bounds();
    let at = |ray: u64| {
        let mut stream = Stream::new(0x6c65_7665, ray);
        let place = Vec3::new(stream.unit(), stream.unit(), stream.unit());
        let ray = Ray::visibility(low + (high - low) * place, stream.sphere());
        let hit = surfaces.cast(&ray, stream.bits() as u32).filter(|hit| hit.faces(ray.direction))?;
        Some(luminance(direct::at_hit(surfaces, lights, &hit)))
    };
    let found: Vec<f32> = (0..RAYS).into_par_iter().filter_map(at).collect();
    exposure::level(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::TriangleSurfaces;
    use rebounce_shared::light::Light;

    #[test]
    fn the_level_is_that_of_the_lit_room_beside_a_dark_one() {
        let scene = crate::io::load("builtin:two-rooms").unwrap();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let of = |lights: &[Light]| {
            let sources: Vec<LightSource> = lights.iter().map(|light| light.source(scene.origin)).collect();
            level(&surfaces, &sources)
        };
        assert_eq!(of(&[]), 0.0);
        let alone = of(&scene.lights);
        let mut dim = scene.lights.clone();
        for light in &mut dim {
            let Light::Spot { position, direction, intensity, .. } = light else { panic!("{light:?}") };
            // Mirrored into the other room.
            (position[0], direction[0]) = (-position[0], -direction[0]);
            *intensity *= 1e-4;
        }
        let both = of(&[scene.lights.clone(), dim.clone()].concat());
        assert!((both / alone - 1.0).abs() < 0.01, "{both}, {alone}");
        let dim = of(&dim);
        assert!((dim / (1e-4 * alone) - 1.0).abs() < 0.1, "{dim}, {alone}");
    }
}
