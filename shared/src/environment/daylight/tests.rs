use super::*;
use crate::colour::luminance;
use std::f32::consts::PI;

fn toward(elevation_deg: f32) -> Vec3 {
    let (sin, cos) = elevation_deg.to_radians().sin_cos();
    Vec3::new(0.6 * cos, sin, 0.8 * cos)
}

/// Illuminance of the sky alone on level ground, lux.
fn illuminance(picture: &Environment) -> f32 {
    luminance(picture.irradiance(Vec3::Y)) * UNIT
}

#[test]
fn clear_skies_have_the_illuminance_of_the_model() {
    // Computed in 64 bits from the authors' data and formula.
    let cases = [(0.0, 2.0, 2427.4), (5.0, 3.0, 6608.0), (30.0, 2.0, 13_031.6), (60.0, 3.0, 17_693.1)];
    for (elevation, turbidity, lux) in cases {
        let (picture, _) = sky(toward(elevation), turbidity, Vec3::splat(0.2));
        let ratio = illuminance(&picture) / lux;
        assert!((ratio - 1.0).abs() < 5e-3, "{elevation} {turbidity}: {ratio}");
    }
}

#[test]
fn the_sky_is_bright_around_the_sun_and_blue_across_from_it() {
    let (picture, sun) = sky(toward(35.0), 3.0, Vec3::splat(0.2));
    let light = |view: Vec3| luminance(picture.radiance(view.normalize()));
    let near = light(toward(38.0));
    let aside = [Vec3::new(0.8, 0.7, -0.6), Vec3::new(-0.8, 0.7, 0.6), Vec3::new(-0.6, 0.7, -0.8), Vec3::Y];
    assert!(aside.into_iter().all(|view| light(view) < 0.4 * near));
    let blue = picture.radiance(Vec3::new(-0.3, 0.9, -0.3).normalize());
    assert!(blue.z > 1.5 * blue.x, "{blue}");
    assert!(sun.unwrap().direction.distance(toward(35.0)) < 1e-6);
}

#[test]
fn the_ground_reflects_what_falls_on_it() {
    let albedo = Vec3::new(0.1, 0.3, 0.5);
    for elevation in [3.0, 50.0, -5.0] {
        let (picture, sun) = sky(toward(elevation), 3.0, albedo);
        let direct = sun.map_or(Vec3::ZERO, |sun| sun.irradiance * toward(elevation).y.max(0.0));
        let expected = albedo * (picture.irradiance(Vec3::Y) + direct) / PI;
        let ground = picture.radiance(-Vec3::Y);
        assert!((ground / expected - 1.0).abs().max_element() < 1e-4);
        assert_eq!(picture.at(7, HEIGHT / 2), ground);
    }
    let (black, _) = sky(toward(30.0), 3.0, Vec3::ZERO);
    assert_eq!(black.radiance(-Vec3::Y), Vec3::ZERO);
}

#[test]
fn a_day_fades_into_night_without_a_jump() {
    for turbidity in [1.0, 2.5, 10.0] {
        let light = |elevation| {
            let (picture, sun) = sky(toward(elevation), turbidity, Vec3::splat(0.2));
            assert!(picture.pixels.iter().all(|pixel| pixel.is_finite() && pixel.min_element() >= 0.0));
            illuminance(&picture) + sun.map_or(0.0, |sun| luminance(sun.irradiance) * UNIT)
        };
        let mut before = light(10.0);
        for step in 1..=300 {
            let now = light(10.0 - 0.1 * step as f32);
            assert!(now <= before * 1.05 && now > 0.6 * before, "{step}: {now} after {before}");
            before = now;
        }
        assert!((1e-4..1e-2).contains(&before), "night: {before} lux");
    }
}

#[test]
fn unusable_arguments_are_taken_into_range() {
    let (picture, sun) = sky(Vec3::ZERO, 50.0, Vec3::splat(9.0));
    let (zenith, _) = sky(Vec3::Y, 10.0, Vec3::ONE);
    assert_eq!(picture, zenith);
    assert!(sun.is_some());
}
