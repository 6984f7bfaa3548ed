use super::rotation::Rotation;
use super::zonal::{COSINE, convolved, factors};
use super::*;
use crate::random::Stream;
use glam::{Mat3, Quat};
use std::f32::consts::{PI, TAU};

mod scipy;

/// Directions of equal solid angle (spherical Fibonacci points).
fn sphere(count: u32) -> impl Iterator<Item = Vec3> {
    (0..count).map(move |k| {
        let z = 1.0 - (2.0 * k as f32 + 1.0) / count as f32;
        let angle = TAU * (k as f64 * 0.618_033_988_749_895).fract() as f32;
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * angle.cos(), r * angle.sin(), z)
    })
}

fn noise(seed: u64) -> Coefficients {
    let mut stream = Stream::new(seed, 25);
    std::array::from_fn(|_| stream.sphere())
}

#[test]
fn values_are_those_of_a_second_implementation() {
    for (direction, expected) in scipy::VALUES {
        for (i, (found, expected)) in evaluate(Vec3::from(direction)).iter().zip(expected).enumerate() {
            assert!((found - expected).abs() < 3e-6, "{direction:?}, {i}: {found} instead of {expected}");
        }
    }
}

#[test]
fn functions_are_orthonormal() {
    const N: u32 = 40_000;
    let mut sums = [[0.0f64; COUNT]; COUNT];
    for direction in sphere(N) {
        let y = evaluate(direction);
        for (row, a) in sums.iter_mut().zip(y) {
            row.iter_mut().zip(y).for_each(|(sum, b)| *sum += f64::from(a * b));
        }
    }
    for (i, row) in sums.iter().enumerate() {
        for (j, sum) in row.iter().enumerate() {
            let product = sum * f64::from(2.0 * TAU) / f64::from(N);
            assert!((product - f64::from(u8::from(i == j))).abs() < 1e-3, "{i} {j}: {product}");
        }
    }
}

#[test]
fn a_turned_function_has_the_values_of_the_turned_directions() {
    let mut stream = Stream::new(3, 1);
    for seed in 0..20 {
        let coefficients = noise(seed);
        let axis = stream.sphere();
        let turn = Mat3::from_quat(Quat::from_axis_angle(axis, stream.unit() * TAU));
        let turned = Rotation::new(turn).apply(&coefficients);
        for _ in 0..20 {
            let direction = stream.sphere();
            let (found, expected) =
                (value(&turned, direction), value(&coefficients, turn.inverse() * direction));
            assert!(found.distance(expected) < 1e-4, "{found} instead of {expected}");
        }
    }
}

#[test]
fn rotations_compose_and_keep_lengths() {
    let mut stream = Stream::new(4, 1);
    let any =
        |stream: &mut Stream| Mat3::from_quat(Quat::from_axis_angle(stream.sphere(), 5.0 * stream.unit()));
    let (a, b, coefficients) = (any(&mut stream), any(&mut stream), noise(9));
    let both = Rotation::new(a).apply(&Rotation::new(b).apply(&coefficients));
    let at_once = Rotation::new(a * b).apply(&coefficients);
    let length = |c: &Coefficients| c.iter().map(|c| c.length_squared()).sum::<f32>();
    assert!(both.iter().zip(&at_once).all(|(x, y)| x.distance(*y) < 1e-5));
    assert!((length(&both) / length(&coefficients) - 1.0).abs() < 1e-5);
}

#[test]
fn convolution_with_a_cosine_is_irradiance() {
    let numeric = factors(|t| t.max(0.0));
    assert!(numeric.iter().zip(COSINE).all(|(a, b)| (a - b).abs() < 1e-5), "{numeric:?}");
    // Radiance 1 + d·y gives π + 2π/3 n·y.
    let mut radiance = [Vec3::ZERO; COUNT];
    radiance[0] = Vec3::splat((2.0 * TAU).sqrt());
    radiance[1] = Vec3::splat((2.0 * TAU / 3.0).sqrt());
    for normal in sphere(50) {
        let found = value(&convolved(&radiance, &COSINE), normal).x;
        assert!((found - PI - 2.0 * PI / 3.0 * normal.y).abs() < 1e-4);
    }
}

#[test]
fn a_narrow_lobe_leaves_a_function_as_it_is() {
    // Eight steps of the quadrature.
    let width = 8.0 * 2.0 / 2048.0;
    let lobe = factors(|t| if t > 1.0 - width { 1.0 / (f64::from(TAU) * width) } else { 0.0 });
    assert!(lobe.iter().all(|factor| (factor - 1.0).abs() < 0.05), "{lobe:?}");
}
