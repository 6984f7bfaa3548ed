use super::*;
use crate::geometry::mesh::TriangleSurfaces;
use crate::geometry::{Gloss, Hit};
use crate::light::direct;
use crate::light::far::UniformEnvironment;
use crate::scene::Scene;
use rebounce_shared::light::{Light, LightSource};
use std::f64::consts::PI;

mod gloss;

#[test]
fn a_closed_room_of_albedo_half_holds_as_much_bounced_light_as_direct() {
    // Flux: the walls receive 4π·I from the lamp; each bounce keeps half. On average over the
    // walls the indirect irradiance is ρ/(1 − ρ) = 1 times the direct irradiance, 4π·I / 24.
    let room = crate::io::load("builtin:furnace").unwrap();
    let surfaces = TriangleSurfaces::from_scene(&room);
    let illumination = Illumination::of(&surfaces, &room.lights[..1], room.origin, 1.0);
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
        let mut of = |only| {
            radiance(&surfaces, &illumination, ray, Settings { only, ..Settings::default() }, &mut stream).x
        };
        direct += of(Only::Direct) as f64;
        indirect += of(Only::Indirect) as f64;
    }
    // Radiance = albedo / π · irradiance.
    let expected = 0.5 / std::f64::consts::PI * 4.0 * std::f64::consts::PI / 24.0;
    assert!((direct / n as f64 / expected - 1.0).abs() < 0.005, "direct {}", direct / n as f64 / expected);
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
    let illumination = Illumination::of(&surfaces, &room.lights, room.origin, 1.0);
    let exposure = Exposure { size: [24, 24], samples: 64, seed: 3 };
    let mean = |bounces| {
        let settings = Settings { only: Only::Indirect, bounces, ..Settings::default() };
        let picture =
            path_trace(&surfaces, room.origin, &room.cameras[0], &illumination, exposure, settings, || ());
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
    let illumination = Illumination::of(&surfaces, &room.lights[..1], room.origin, 1.0);
    let settings = Settings { only: Only::Indirect, ..Settings::default() };
    let paths: Vec<f64> = (0..20_000)
        .map(|i| {
            let ray =
                Ray { origin: Vec3::ZERO, direction: Vec3::Y, max_distance: f32::INFINITY, spread: 0.0 };
            radiance(&surfaces, &illumination, ray, settings, &mut Stream::new(1, i)).x.into()
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
    let illumination = Illumination::of(&surfaces, &room.lights, room.origin, 1.0);
    let exposure = Exposure { size: [16, 16], samples: 8, seed: 5 };
    let take = |only, threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let settings = Settings { only, ..Settings::default() };
        pool.install(|| {
            path_trace(&surfaces, room.origin, &room.cameras[0], &illumination, exposure, settings, || ())
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

/// A ray from the middle of the furnace, a room from −1 to 1.
fn ray(direction: Vec3) -> Ray {
    Ray { origin: Vec3::new(0.1, -0.2, 0.05), direction, max_distance: f32::INFINITY, spread: 0.0 }
}

/// Mean of the radiance along a ray.
fn mean(surfaces: &impl Surfaces, illumination: &Illumination, ray: Ray, only: Only, samples: u64) -> f64 {
    let settings = Settings { only, ..Settings::default() };
    let of = |i| f64::from(radiance(surfaces, illumination, ray, settings, &mut Stream::new(4, i)).x);
    (0..samples).map(of).sum::<f64>() / samples as f64
}

fn close(found: f64, expected: f64, most: f64) {
    assert!((found / expected - 1.0).abs() < most, "{found}, not {expected}");
}

#[test]
fn a_closed_room_whose_walls_shine_is_equally_bright_everywhere() {
    let mut room = crate::io::load("builtin:furnace").unwrap();
    for (albedo, is_two_sided) in [(0.5f32, false), (0.8, true)] {
        room.materials.iter_mut().for_each(|material| {
            material.base_color = [albedo, albedo, albedo, 1.0];
            material.emission = [0.7; 3];
            material.double_sided = is_two_sided;
        });
        let surfaces = TriangleSurfaces::from_scene(&room);
        let illumination = Illumination::new(&surfaces, &[]);
        for direction in
            [Vec3::X, Vec3::new(0.3, -0.8, 0.2).normalize(), Vec3::new(0.6, 0.6, -0.6).normalize()]
        {
            let of = |only| mean(&surfaces, &illumination, ray(direction), only, 20_000);
            let albedo = f64::from(albedo);
            close(of(Only::All), 0.7 / (1.0 - albedo), 0.01);
            close(of(Only::Direct), 0.7 * (1.0 + albedo), 0.01);
            close(of(Only::Indirect), 0.7 / (1.0 - albedo) * albedo * albedo, 0.015);
        }
        // Half the emission, half the light; none, none.
        let half = Illumination::new(&surfaces, &[]).with_emission(Vec3::splat(0.5));
        close(
            mean(&surfaces, &half, ray(Vec3::X), Only::All, 20_000),
            0.35 / (1.0 - f64::from(albedo)),
            0.01,
        );
        let none = Illumination::of(&surfaces, &[], room.origin, 0.0);
        assert_eq!(mean(&surfaces, &none, ray(Vec3::X), Only::All, 10), 0.0);
    }
}

/// Irradiance at a hit by rays alone, which find what shines by chance.
fn by_chance(surfaces: &impl Surfaces, hit: &Hit, samples: u64) -> f64 {
    let of = |i| {
        let mut stream = Stream::new(9, i);
        let direction = stream.cosine_hemisphere(hit.normal);
        let origin = hit.offset_origin(direction, surfaces.epsilon_at(hit.position));
        let found = surfaces.cast(&Ray { origin, direction, max_distance: f32::INFINITY, spread: 0.0 }, 0);
        found.map_or(0.0, |hit| PI * f64::from(hit.emission.x))
    };
    (0..samples).map(of).sum::<f64>() / samples as f64
}

#[test]
fn area_lights_give_the_same_sampled_and_found_by_chance_and_by_both() {
    let room = crate::io::load("builtin:furnace").unwrap();
    let inner = TriangleSurfaces::from_scene(&room);
    let (color, direction, up) = ([1.0; 3], [0.2, -1.0, 0.1], [0.0; 3]);
    let lights = [
        Light::Rectangle {
            position: [0.3, 0.4, 0.0],
            direction,
            up,
            width: 0.8,
            height: 0.4,
            intensity: 2.0,
            color,
        },
        Light::Disk { position: [-0.3, -0.7, 0.3], direction, radius: 0.4, intensity: 1.0, color },
        Light::Sphere { position: [-0.4, 0.2, -0.5], radius: 0.3, intensity: 3.0, color },
    ];
    let sources: Vec<LightSource> = lights.iter().map(|light| light.source(room.origin)).collect();
    let surfaces = WithLights::new(&inner, &sources);
    let illumination = Illumination::new(&surfaces, &sources);
    for (x, z) in [(0.0, 0.0), (-0.35, 0.2), (0.7, -0.6)] {
        let down = Ray { origin: Vec3::new(x, -0.95, z), ..ray(Vec3::NEG_Y) };
        let hit = surfaces.cast(&down, 0).unwrap();
        let chance = by_chance(&surfaces, &hit, 300_000);
        let sampled = |i| f64::from(direct::toward_hit(&surfaces, &sources, &hit, &mut Stream::new(2, i)).x);
        close((0..100_000).map(sampled).sum::<f64>() / 100_000.0, chance, 0.015);
        // The floor reflects a half.
        close(mean(&surfaces, &illumination, down, Only::Direct, 100_000) * PI / 0.5, chance, 0.015);
    }
}

/// The furnace without lamps, one wall of which shines, with a pattern of two triangles.
fn shining_wall() -> Scene {
    let mut room = crate::io::load("builtin:furnace").unwrap();
    let mut bright = room.materials[0].clone();
    bright.emission = [2.0; 3];
    let mut dim = room.materials[0].clone();
    dim.emission = [0.3; 3];
    let number = room.materials.len() as u32;
    room.materials.extend([bright, dim]);
    room.triangle_material[0] = number;
    room.triangle_material[1] = number + 1;
    room.lights.clear();
    room
}

#[test]
fn shining_triangles_give_the_same_by_chance_and_sampled_besides() {
    let room = shining_wall();
    let surfaces = TriangleSurfaces::from_scene(&room);
    let illumination = Illumination::new(&surfaces, &[]);
    let mut lit = 0;
    for direction in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z] {
        let hit = surfaces.cast(&ray(direction), 0).unwrap();
        let chance = by_chance(&surfaces, &hit, 300_000);
        if chance > 0.0 {
            lit += 1;
            let found = mean(&surfaces, &illumination, ray(direction), Only::Direct, 100_000);
            close((found - f64::from(hit.emission.x)) * PI / 0.5, chance, 0.015);
        }
    }
    assert_eq!(lit, 5);
}

/// A white ball of radius 1.
struct Ball(Gloss);

impl Surfaces for Ball {
    fn cast(&self, ray: &Ray, _seed: u32) -> Option<Hit> {
        let along = -ray.origin.dot(ray.direction);
        let half = (1.0 - (ray.origin + along * ray.direction).length_squared()).sqrt();
        let distance = along - half;
        let position = ray.origin + ray.direction * distance;
        let normal = position.normalize_or_zero();
        (distance > 0.0 && distance <= ray.max_distance).then_some(Hit {
            distance,
            position,
            geometric_normal: normal,
            normal,
            albedo: Vec3::ONE,
            emission: Vec3::ZERO,
            emitter: None,
            is_unlit: false,
            group: 0,
            lightmap: None,
            gloss: self.0,
        })
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        self.cast(ray, seed)
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        let hides = self.cast(&Ray { origin: from, ..ray((to - from).normalize()) }, 0).is_some();
        if hides { Vec3::ZERO } else { Vec3::ONE }
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        (Vec3::NEG_ONE, Vec3::ONE)
    }

    fn epsilon(&self) -> f32 {
        1e-4
    }
}

#[test]
fn a_white_ball_under_a_white_sky_is_as_bright_as_the_sky() {
    let ball = Ball(Gloss::MATT);
    let illumination = Illumination::new(&ball, &[]).with_environment(UniformEnvironment(Vec3::splat(0.8)));
    for aside in [0.0, 0.5, 0.9] {
        let ray = Ray { origin: Vec3::new(aside, 0.0, 3.0), ..ray(Vec3::NEG_Z) };
        close(mean(&ball, &illumination, ray, Only::Direct, 20_000), 0.8, 0.01);
        close(mean(&ball, &illumination, ray, Only::All, 20_000), 0.8, 0.01);
    }
    let past = Ray { origin: Vec3::new(0.0, 3.0, 3.0), ..ray(Vec3::NEG_Z) };
    close(mean(&ball, &illumination, past, Only::Direct, 1), 0.8, 1e-6);
}
