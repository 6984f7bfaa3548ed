use super::*;
use crate::environment::environment_from_world;
use crate::random::Stream;

fn noise(width: u32, height: u32) -> Environment {
    let mut stream = Stream::new(8, u64::from(width));
    let pixels =
        (0..width * height).map(|_| Vec3::new(stream.unit(), stream.unit(), stream.unit().powi(9) * 90.0));
    Environment { width, height, pixels: pixels.collect() }
}

#[test]
fn the_map_and_its_inverse_round_trip() {
    let mut stream = Stream::new(1, 0);
    for _ in 0..100_000 {
        let there = stream.sphere();
        assert!(decode(encode(there)).distance(there) < 2e-6, "{there}");
        let place = stream.square();
        assert!(encode(decode(place)).distance(place) < 2e-6, "{place}");
    }
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        assert!(decode(encode(axis)).distance(axis) < 1e-6 && decode(encode(-axis)).distance(-axis) < 1e-6);
    }
}

#[test]
fn directions_of_a_bin_are_in_it() {
    let mut stream = Stream::new(2, 0);
    for bin in 0..BINS {
        for _ in 0..200 {
            let place = stream.square() * 0.999 + 0.0005;
            assert_eq!(bin_of(direction(bin, place)), bin);
        }
    }
}

#[test]
fn bins_have_equal_areas() {
    let count = 1_000_000;
    let mut found = [0u32; BINS];
    let mut stream = Stream::new(3, 0);
    for _ in 0..count {
        found[bin_of(stream.sphere())] += 1;
    }
    let mean = f64::from(count) / BINS as f64;
    // Five standard deviations: 8% of a bin.
    assert!(found.iter().all(|&n| (f64::from(n) - mean).abs() < 5.0 * mean.sqrt()));
    // The cosine to any axis integrates to π over its hemisphere.
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let cosines = (0..64 * BINS).map(|i| direction(i % BINS, stream.square()).dot(axis).max(0.0));
        let integral = cosines.sum::<f32>() / 64.0 * SOLID_ANGLE;
        assert!((integral - PI).abs() < 0.02, "{axis}: {integral}");
    }
}

#[test]
fn four_bins_in_a_row_are_one_of_the_coarser_grid() {
    for bin in 0..BINS {
        let place = encode(direction(bin, Vec2::splat(0.5)));
        for (side, shift) in [(8.0, 2), (4.0, 4), (2.0, 6)] {
            let [x, y] = (place * side).to_array().map(|x| x as usize);
            assert_eq!(spread(x) | spread(y) << 1, bin >> shift);
        }
    }
}

#[test]
fn the_horizon_is_a_border() {
    let mut stream = Stream::new(4, 0);
    for bin in 0..BINS {
        for _ in 0..100 {
            assert_eq!(direction(bin, stream.square()).y > 0.0, bin >= BINS / 2, "bin {bin}");
        }
    }
}

#[test]
fn a_turned_constant_stays_constant_and_no_bin_is_without_samples() {
    let constant = Vec3::new(0.3, 2.0, 5.0);
    for (width, height) in [(1, 1), (2, 1), (1, 8), (6, 3), (128, 1), (1, 64), (100, 3), (128, 64)] {
        let pixels = vec![constant; (width * height) as usize];
        let picture = Environment { width, height, pixels };
        for rotation in [0.0, 10.0, 123.4] {
            let bins = project(&picture, rotation);
            assert!(bins.iter().all(|bin| bin.distance(constant) < 1e-5), "{width} {height}");
        }
    }
}

#[test]
fn energy_is_kept_under_rotation() {
    for (width, height) in [(512, 256), (128, 64), (16, 8), (4, 2)] {
        let picture = noise(width, height);
        for rotation in [0.0, 33.3, -100.0] {
            let ratio = energy(&project(&picture, rotation)) / picture.energy();
            assert!((ratio - 1.0).abs().max_element() < 1e-5, "{width} {rotation}: {ratio}");
        }
    }
}

#[test]
fn a_single_bright_pixel_changes_what_is_elsewhere_by_a_fifth_of_a_percent_at_most() {
    let dark = 0.01;
    let mut pixels = vec![Vec3::splat(dark); 512 * 256];
    pixels[70 * 512 + 300] = Vec3::splat(20_000.0);
    let picture = Environment { width: 512, height: 256, pixels };
    for step in 0..12 {
        let bins = project(&picture, step as f32 * 7.7);
        assert!((energy(&bins).x / picture.energy().x - 1.0).abs() < 1e-5);
        let lit = bins.iter().filter(|bin| (bin.x / dark - 1.0).abs() > 2e-3).count();
        assert!((1..=4).contains(&lit), "{step}: {lit}");
    }
}

#[test]
fn turning_the_picture_by_a_quarter_is_turning_directions() {
    let picture = noise(64, 32);
    // Content that was at column x is at x − 16: from +x, the middle, to −z.
    let column = |x: u32, y: u32| picture.at((x + 16) % 64, y);
    let pixels = (0..32).flat_map(|y| (0..64).map(move |x| (x, y))).map(|(x, y)| column(x, y)).collect();
    let turned = Environment { width: 64, height: 32, pixels };
    let mut stream = Stream::new(6, 0);
    for _ in 0..1000 {
        let world = stream.sphere();
        let apart = turned.radiance(world) - picture.radiance(environment_from_world(world, 90.0));
        assert!(apart.abs().max_element() < 0.02, "{apart}");
    }
    for (a, b) in project(&turned, 0.0).iter().zip(project(&picture, 90.0)) {
        assert!(a.distance(b) < 0.01 * (1.0 + b.length()), "{a} {b}");
    }
}

#[test]
fn a_sky_lights_no_bin_below_the_horizon() {
    let pixels = (0..128 * 64).map(|i| if i < 128 * 32 { Vec3::ONE } else { Vec3::ZERO }).collect();
    let sky = Environment { width: 128, height: 64, pixels };
    for rotation in [0.0, 20.0] {
        let bins = project(&sky, rotation);
        assert!(bins[..BINS / 2].iter().all(|bin| bin.x == 0.0));
        assert!(bins[BINS / 2..].iter().all(|bin| (bin.x - 1.0).abs() < 1e-5));
    }
}
