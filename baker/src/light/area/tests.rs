use super::*;
use crate::geometry::mesh::TriangleSurfaces;
use crate::geometry::with_lights::{WithLights, meet};
use crate::geometry::{Gloss, Hit, Surfaces};
use crate::light::direct;
use crate::random::Stream;
use rebounce_shared::light::Light;

const WHITE: [f64; 3] = [1.0; 3];

fn rectangle(position: [f64; 3], direction: [f64; 3], width: f64, height: f64) -> LightSource {
    let up = [0.0; 3];
    Light::Rectangle { position, direction, up, width, height, intensity: 1.0, color: WHITE }.source([0.0; 3])
}

fn disk(position: [f64; 3], radius: f64) -> LightSource {
    let direction = [0.0, -1.0, 0.0];
    Light::Disk { position, direction, radius, intensity: 1.0, color: WHITE }.source([0.0; 3])
}

fn sphere(position: [f64; 3], radius: f64) -> LightSource {
    Light::Sphere { position, radius, intensity: 1.0, color: WHITE }.source([0.0; 3])
}

/// Irradiance at the origin, on a surface with this normal: the mean of random samples.
fn irradiance(light: &LightSource, normal: Vec3) -> f64 {
    let mut stream = Stream::new(1, 2);
    let samples = 200_000;
    let sum: f64 = (0..samples)
        .filter_map(|_| sample(light, Vec3::ZERO, stream.square()))
        .map(|at| f64::from(normal.dot(at.to_light).max(0.0) / at.density))
        .sum();
    sum / samples as f64
}

fn close(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 0.005, "{found}, not {expected}");
}

#[test]
fn a_rectangle_has_the_irradiance_of_its_form_factor() {
    // Form factors of a small surface and a rectangle over its corner (Howell: A Catalog of Radiation Heat Transfer
    // Configuration Factors, B-3 and B-4), times π.
    for (a, b, c) in [(1.0f64, 0.5f64, 2.0f64), (3.0, 1.0, 0.2), (0.5, 4.0, 0.02)] {
        let (x, y) = (a / c, b / c);
        let side = |x: f64, y: f64| x / x.hypot(1.0) * (y / x.hypot(1.0)).atan();
        let parallel = 0.5 * (side(x, y) + side(y, x));
        // Seen from below, the height is along x.
        let above = rectangle([0.5 * a, c, 0.5 * b], [0.0, -1.0, 0.0], b, a);
        close(irradiance(&above, Vec3::Y), parallel);
        // The rectangle stands on the surface's plane, `c` ahead.
        let (x, y) = (b / c, a / c);
        let perpendicular = 0.5 * (y.atan() - (y / x.hypot(1.0)).atan() / x.hypot(1.0));
        let ahead = rectangle([0.5 * a, 0.5 * b, c], [0.0, 0.0, -1.0], a, b);
        close(irradiance(&ahead, Vec3::Y), perpendicular);
    }
}

#[test]
fn a_disk_has_the_irradiance_of_its_sine_on_its_axis() {
    for (radius, height) in [(1.0f64, 2.0f64), (1.0, 0.01), (0.3, 40.0), (1.0, 5000.0)] {
        let expected = PI * radius * radius / (radius * radius + height * height);
        close(irradiance(&disk([0.0, height, 0.0], radius), Vec3::Y), expected);
    }
}

#[test]
fn a_disk_beside_the_axis_has_the_irradiance_of_its_form_factor() {
    // Howell, B-13: a parallel surface at a distance from the axis.
    for (radius, height, aside) in
        [(1.0f64, 0.5f64, 0.7f64), (1.0, 0.1, 0.99), (1.0, 0.1, 1.01), (0.5, 1.0, 4.0)]
    {
        let (h, r) = (height / aside, radius / aside);
        let z = 1.0 + h * h + r * r;
        let expected = 0.5 * PI * (1.0 - (1.0 + h * h - r * r) / (z * z - 4.0 * r * r).sqrt());
        close(irradiance(&disk([aside, height, 0.0], radius), Vec3::Y), expected);
    }
}

#[test]
fn a_sphere_has_the_irradiance_of_its_solid_angle() {
    let normal = Vec3::new(0.5, 1.0, 0.0).normalize();
    for (radius, distance) in [(0.5f64, 2.0f64), (0.01, 3.0), (1.0, 1.2)] {
        let expected = PI * (radius / distance).powi(2);
        let found = irradiance(&sphere([0.0, distance, 0.0], radius), Vec3::Y);
        close(found, expected);
        if radius < distance * 0.3 {
            let tilted = irradiance(&sphere([0.0, distance, 0.0], radius), normal);
            close(tilted, expected * f64::from(normal.y));
        }
    }
}

#[test]
fn nothing_comes_from_behind_or_within() {
    let square = Vec2::splat(0.3);
    assert!(sample(&disk([0.0, -1.0, 0.0], 1.0), Vec3::ZERO, square).is_none());
    assert!(sample(&rectangle([0.0, -1.0, 0.0], [0.0, -1.0, 0.0], 1.0, 1.0), Vec3::ZERO, square).is_none());
    assert!(sample(&sphere([0.0, 0.1, 0.0], 0.2), Vec3::ZERO, square).is_none());
}

#[test]
fn samples_lie_on_the_light_and_have_bounded_weight() {
    let lights = [
        rectangle([0.3, 0.02, 0.1], [-0.1, -1.0, -0.2], 1.0, 0.5),
        disk([0.3, 0.02, 0.1], 0.5),
        disk([0.6, 0.02, 0.1], 0.5),
        disk([3.0, 2.0, 0.1], 0.5),
        sphere([0.3, 0.4, 0.1], 0.3),
    ];
    for light in lights {
        let mut stream = Stream::new(4, 2);
        for _ in 0..10_000 {
            let at = sample(&light, Vec3::ZERO, stream.square()).unwrap();
            let found = density(&light, Vec3::ZERO, at.position);
            assert!((found / at.density - 1.0).abs() < 1e-3 && 1.0 / at.density < 7.0, "{light:?} {at:?}");
            // Rays to the very edge may miss.
            if let Some(met) = meet(&light, Vec3::ZERO, at.to_light) {
                let off = (met.distance * at.to_light - at.position).length();
                assert!(off < 2e-2, "{light:?}: {off}");
            }
        }
    }
}

#[test]
fn fixed_samples_are_one_a_cell() {
    let cell = |sample: u32, count: u32| {
        let at = (fixed(sample) * count as f32).floor();
        (at.y * count as f32 + at.x) as u32
    };
    assert_eq!((0..16).map(|i| 1 << cell(i, 4)).fold(0, |all: u32, bit| all | bit), 0xffff);
    for first in [0, 4, 8, 12] {
        assert_eq!((first..first + 4).map(|i| 1 << cell(i, 2)).fold(0, |all: u32, bit| all | bit), 0xf);
    }
}

#[test]
fn fixed_samples_are_near_the_closed_form_and_a_half_is_hidden_by_a_screen() {
    let scene = crate::io::load("builtin:furnace").unwrap();
    let room = TriangleSurfaces::from_scene(&scene);
    let lamp = [rectangle([0.0, 0.5, 0.0], [0.0, -1.0, 0.0], 0.5, 0.5)];
    let surfaces = WithLights::new(&room, &lamp);
    let floor = Vec3::new(0.0, -1.0, 0.0);
    let expected = {
        let side = |x: f64| 2.0 * x / x.hypot(1.0) * (x / x.hypot(1.0)).atan();
        4.0 * 0.5 * side(0.25 / 1.5)
    };
    close(direct::at_point(&surfaces, &lamp, floor, Vec3::Y).x.into(), expected);
    // A second, dark light hides one half.
    let mut screen = rectangle([0.25, 0.25, 0.0], [0.0, -1.0, 0.0], 2.0, 0.5);
    screen.intensity = Vec3::ZERO;
    let both = [lamp[0], screen];
    let surfaces = WithLights::new(&room, &both);
    close(direct::at_point(&surfaces, &both, floor, Vec3::Y).x.into(), 0.5 * expected);
    let hit = Hit {
        distance: 1.0,
        position: floor,
        geometric_normal: Vec3::Y,
        normal: Vec3::Y,
        albedo: Vec3::ONE,
        emission: Vec3::ZERO,
        emitter: None,
        is_unlit: false,
        group: 0,
        lightmap: None,
        gloss: Gloss::MATT,
    };
    let mut stream = Stream::new(1, 1);
    let sum: f64 =
        (0..100_000).map(|_| f64::from(direct::toward_hit(&surfaces, &both, &hit, &mut stream).x)).sum();
    close(sum / 100_000.0, 0.5 * expected);
    assert!(surfaces.epsilon() > 0.0);
}
