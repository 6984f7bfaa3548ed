//! Metals as GGX conductors.

use super::*;
use crate::light::far::Environment;
use glam::Vec2;

fn metal(roughness: f32) -> Gloss {
    Gloss { metallic: 1.0, roughness, specular: 0.5 }
}

/// A ray down −z that meets the ball of radius 1 so far from its middle.
fn past(aside: f32) -> Ray {
    Ray { origin: Vec3::new(0.6 * aside, -0.8 * aside, 3.0), ..ray(Vec3::NEG_Z) }
}

/// Mean of the radiance along a ray, with gloss.
fn mean_of(surfaces: &impl Surfaces, illumination: &Illumination, ray: Ray, only: Only, samples: u64) -> f64 {
    let settings = Settings { only, gloss: true, ..Settings::default() };
    let of = |i| f64::from(radiance(surfaces, illumination, ray, settings, &mut Stream::new(4, i)).x);
    (0..samples).map(of).sum::<f64>() / samples as f64
}

/// Radiance from a hit by rays alone, which find what shines by chance.
fn by_lobe(
    surfaces: &impl Surfaces,
    illumination: &Illumination,
    (hit, to_eye): (&Hit, Vec3),
    samples: u64,
) -> f64 {
    let bsdf = Bsdf::new(hit, to_eye, true);
    let of = |i| {
        let Some(sample) = bsdf.sample(&mut Stream::new(9, i)) else { return 0.0 };
        let direction = sample.to_light;
        let origin = hit.offset_origin(direction, surfaces.epsilon_at(hit.position));
        let next = surfaces.cast(&Ray { origin, ..ray(direction) }, 0);
        let found = next.map_or(illumination.environment(direction).0, |next| next.emission);
        f64::from((bsdf.albedo * sample.weight * found).x)
    };
    (0..samples).map(of).sum::<f64>() / samples as f64
}

#[test]
fn a_white_metal_ball_under_a_white_sky_is_as_bright_as_the_sky() {
    for roughness in [0.1, 0.3, 0.6, 1.0] {
        let ball = Ball(metal(roughness));
        let illumination = Illumination::new(&ball, &[]).with_environment(UniformEnvironment(Vec3::ONE));
        for aside in [0.0, 0.5, 0.9, 0.99] {
            close(mean_of(&ball, &illumination, past(aside), Only::All, 40_000), 1.0, 0.01);
        }
    }
}

/// Dark but for a cap as bright as a lamp; samples know nothing of it.
struct Cap;

impl Environment for Cap {
    fn radiance(&self, direction: Vec3) -> Vec3 {
        Vec3::splat(if direction.y + direction.z > 1.3 { 20.0 } else { 0.1 })
    }

    fn sample(&self, square: Vec2) -> (Vec3, f32) {
        UniformEnvironment(Vec3::ONE).sample(square)
    }

    fn density(&self, direction: Vec3) -> f32 {
        UniformEnvironment(Vec3::ONE).density(direction)
    }
}

#[test]
fn metals_under_a_sky_and_a_small_light_are_the_same_sampled_and_found_by_chance() {
    let (position, color) = ([0.5, 1.0, 2.2], [1.0; 3]);
    let light = Light::Sphere { position, radius: 0.25, intensity: 40.0, color }.source([0.0; 3]);
    for roughness in [0.2, 0.45, 0.9] {
        let inner = Ball(metal(roughness));
        let surfaces = WithLights::new(&inner, &[light]);
        let small = Illumination::new(&surfaces, &[light]);
        let sky = Illumination::new(&inner, &[]).with_environment(Cap);
        for aside in [0.0, 0.3, 0.8] {
            let hit = inner.cast(&past(-aside), 0).unwrap();
            let at = (&hit, Vec3::Z);
            let chance = by_lobe(&inner, &sky, at, 300_000);
            close(mean_of(&inner, &sky, past(-aside), Only::All, 200_000), chance, 0.02);
            let chance = by_lobe(&surfaces, &small, at, 300_000);
            let found = mean_of(&surfaces, &small, past(-aside), Only::All, 100_000);
            assert!((found - chance).abs() < 0.02 * chance + 2e-3, "{roughness} {aside}: {found} {chance}");
        }
    }
}

#[test]
fn shining_triangles_in_metal_walls_are_the_same_sampled_and_found_by_chance() {
    let mut room = shining_wall();
    for material in &mut room.materials {
        (material.metallic, material.roughness) = (1.0, 0.4);
    }
    let surfaces = TriangleSurfaces::from_scene(&room);
    let illumination = Illumination::new(&surfaces, &[]);
    let mut lit = 0;
    for direction in [Vec3::X, Vec3::Y, Vec3::new(-0.2, -0.7, 0.5).normalize(), Vec3::NEG_Z] {
        let hit = surfaces.cast(&ray(direction), 0).unwrap();
        let chance = by_lobe(&surfaces, &illumination, (&hit, -direction), 300_000);
        let found = mean_of(&surfaces, &illumination, ray(direction), Only::Direct, 100_000);
        let found = found - f64::from(hit.emission.x);
        assert!((found - chance).abs() < 0.02 * chance + 1e-3, "{found} {chance}");
        lit += u32::from(chance > 0.05);
    }
    assert!(lit >= 2);
}

#[test]
fn a_lamp_on_a_metal_is_weighed_by_its_reflectance() {
    let ball = Ball(metal(0.5));
    let lamp = Light::Point { position: [1.0, 2.0, 3.0], intensity: 5.0, color: [1.0; 3], radius: 0.0 };
    let lamp = lamp.source([0.0; 3]);
    let illumination = Illumination::new(&ball, &[lamp]);
    let hit = ball.cast(&past(0.4), 0).unwrap();
    let reflectance =
        Bsdf::new(&hit, Vec3::Z, true).reflectance((lamp.position - hit.position).normalize()).x;
    let irradiance = direct::at_hit(&ball, &[lamp], &hit).x;
    let found = mean_of(&ball, &illumination, past(0.4), Only::All, 1);
    close(found, f64::from(reflectance * irradiance), 1e-4);
}

#[test]
fn without_gloss_a_metal_is_lambertian() {
    let (matt, metal) = (Ball(Gloss::MATT), Ball(metal(0.3)));
    let lamp = Light::Point { position: [1.0, 2.0, 3.0], intensity: 5.0, color: [1.0; 3], radius: 0.5 };
    let of = |ball: &Ball, gloss: bool, i| {
        let illumination = Illumination::new(ball, &[lamp.source([0.0; 3])]).with_environment(Cap);
        let settings = Settings { gloss, ..Settings::default() };
        radiance(ball, &illumination, past(0.4), settings, &mut Stream::new(3, i))
    };
    for i in 0..100 {
        assert_eq!(of(&metal, false, i), of(&matt, false, i));
        assert_eq!(of(&matt, true, i), of(&matt, false, i));
        assert_ne!(of(&metal, true, i), of(&matt, true, i));
    }
}
