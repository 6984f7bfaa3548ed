use super::*;

/// A sky of a gradient, with a disk of light.
fn sky(width: u32, toward: Vec3, radius_deg: f32, radiance: f32) -> Environment {
    let height = width / 2;
    let mut picture = Environment { width, height, pixels: Vec::new() };
    for y in 0..height {
        for x in 0..width {
            // 5 by 5 samples, so that the disk has its solid angle.
            let mut sum = Vec3::ZERO;
            for i in 0..25 {
                let at = |x: u32, i: u32, n: u32| (f64::from(x) + (f64::from(i) + 0.5) / 5.0) / f64::from(n);
                let there = super::super::picture::direction_at(at(x, i % 5, width), at(y, i / 5, height));
                let blue = Vec3::new(0.2, 0.4, 0.9) * (1.2 - there.y);
                let is_sun = there.dot(toward) > radius_deg.to_radians().cos();
                sum += if is_sun { Vec3::new(1.0, 0.9, 0.7) * radiance } else { blue };
            }
            picture.pixels.push(sum / 25.0);
        }
    }
    picture
}

fn toward() -> Vec3 {
    Vec3::new(0.5, 0.6, -0.4).normalize()
}

fn assert_energy_is_kept(before: &Environment, after: &Environment, sun: &Sun) {
    let ratio = (after.energy() + sun.irradiance.as_dvec3()) / before.energy();
    assert!((ratio - 1.0).abs().max_element() < 1e-6, "{ratio}");
}

#[test]
fn a_sun_is_found_with_its_place_size_and_light() {
    for (width, radius_deg) in [(1024, 0.5), (1024, 1.5), (512, 1.0), (512, 4.0)] {
        let picture = sky(width, toward(), radius_deg, 20_000.0);
        let (rest, sun) = extract_sun(&picture);
        let sun = sun.unwrap();
        assert!(sun.direction.angle_between(toward()).to_degrees() < 0.05, "{sun:?}");
        assert!((sun.radius_deg / radius_deg - 1.0).abs() < 0.1, "{sun:?}");
        let solid_angle = 4.0 * std::f32::consts::PI * (0.5 * radius_deg.to_radians()).sin().powi(2);
        assert!((sun.irradiance.x / (20_000.0 * solid_angle) - 1.0).abs() < 0.05, "{sun:?}");
        assert_energy_is_kept(&picture, &rest, &sun);
        assert!(rest.luminances().iter().all(|&l| l < 10.0));
    }
}

#[test]
fn a_sun_of_one_pixel_at_the_seam_or_the_zenith_is_found() {
    for pixel in [80 * 512, 80 * 512 + 511, 5, 30 * 512 + 77] {
        let mut picture = sky(512, toward(), 0.0, 0.0);
        picture.pixels[pixel] = Vec3::splat(200_000.0);
        let (rest, sun) = extract_sun(&picture);
        let sun = sun.unwrap();
        assert!(sun.direction.angle_between(direction_of(&picture, pixel)).to_degrees() < 0.01);
        assert!((0.1..0.5).contains(&sun.radius_deg), "{sun:?}");
        assert_energy_is_kept(&picture, &rest, &sun);
    }
}

#[test]
fn what_bins_can_show_stays() {
    let kept = |picture: &Environment, what: &str| {
        let (rest, sun) = extract_sun(picture);
        assert!(sun.is_none() && rest == *picture, "{what}: {sun:?}");
    };
    kept(&sky(512, toward(), 0.0, 0.0), "a sky without a sun");
    kept(&sky(512, toward(), 8.0, 3000.0), "a softbox");
    kept(&sky(512, toward(), 15.0, 50.0), "a window");
    kept(&sky(512, toward(), 0.5, 60.0), "a faint lamp");
    kept(&sky(512, toward(), 1.0, 6.0), "a clouded sky");
    kept(&sky(512, Vec3::new(0.6, -0.6, 0.1).normalize(), 0.5, 20_000.0), "a lamp below the horizon");
    kept(&Environment::constant(Vec3::ONE), "a constant");
    kept(&Environment::constant(Vec3::ZERO), "darkness");
    kept(&sky(16, toward(), 5.0, 1000.0), "coarse pixels");
}
