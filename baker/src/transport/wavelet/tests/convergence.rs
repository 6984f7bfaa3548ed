//! Orders of convergence, and the same result on any number of threads.

use super::*;
use crate::job::watch::Stopped;
use crate::transport::wavelet::{Order, WaveletError};

#[test]
fn errors_fall_with_the_order_of_the_basis() {
    let lamp = [[-0.6, -0.4], [0.5, -0.4], [0.5, 0.7], [-0.6, 0.7]].map(|[x, z]| DVec3::new(x, 1.3, z));
    let frame = Frame { origin: 1.3 * DVec3::Y, x: DVec3::X, y: DVec3::NEG_Z, z: DVec3::NEG_Y };
    let loops = vec![rectangle(DVec2::new(-0.6, -0.7), DVec2::new(0.5, 0.4))];
    let patches = [
        flat(DVec3::ZERO, DVec3::Y, vec![rectangle(DVec2::new(-0.9, -0.7), DVec2::new(1.0, 1.1))]),
        shining(patch_of(Surface::Plane(frame), false, loops)),
    ];
    // Lambert's formula, of a point of the floor and a polygon above it.
    let closed_form = |position: DVec3| {
        let edge = |i: usize| {
            let [a, b] = [lamp[i], lamp[(i + 1) % 4]].map(|corner| corner - position);
            a.angle_between(b) * b.cross(a).normalize().y
        };
        (0..4).map(edge).sum::<f64>().abs() / TAU
    };
    let error = |order: Order, level: u32| {
        let settings = WaveletSettings {
            order,
            epsilon: 1e-6,
            min_level: level,
            max_level: level,
            ..WaveletSettings::default()
        };
        let solution = solved(&patches, &settings);
        let square = |(st, share): (DVec2, f64)| {
            let exact = closed_form(patches[0].mesh.point(st));
            share * (f64::from(solution.irradiance_of_emitters(0, st).x) - exact).powi(2)
        };
        real_points(&patches[0], 48).into_iter().map(square).sum::<f64>().sqrt()
    };
    let errors = [Order::M1, Order::M2, Order::M3].map(|order| [1, 2, 3].map(|level| error(order, level)));
    println!("{errors:?}");
    for pair in errors.windows(2) {
        assert!(pair[0].iter().zip(pair[1]).all(|(lower, higher)| higher < 0.5 * lower), "{pair:?}");
    }
    for (index, least) in [1.8, 3.4, 6.0].into_iter().enumerate() {
        let ratio = errors[index][1] / errors[index][2];
        assert!(ratio > least, "order {}: {ratio}", index + 1);
    }
}

/// A sphere above a floor under a lamp, beside a wall that shines.
fn scene() -> Vec<WaveletPatch> {
    let grey = |patch| WaveletPatch { albedo: Vec3::new(0.7, 0.6, 0.5), ..patch };
    vec![
        grey(flat(DVec3::ZERO, DVec3::Y, vec![rectangle(DVec2::splat(-2.0), DVec2::splat(2.0))])),
        grey(sphere(DVec3::new(0.2, 0.8, 0.1), 0.4, false)),
        grey(sphere(DVec3::Y, 1.9, true)),
        shining(grey(flat(DVec3::new(-1.0, 1.0, 0.0), DVec3::X, vec![circle(0.5)]))),
    ]
}

#[test]
fn the_bits_are_the_same_with_one_and_two_threads() {
    let lamp = |position: Vec3, normal: Vec3| {
        let to = Vec3::new(0.3, 2.0, 0.2) - position;
        Vec3::splat(to.normalize().dot(normal).max(0.0) / to.length_squared())
    };
    let settings = WaveletSettings { max_level: 3, epsilon: 0.1, ..WaveletSettings::default() };
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&scene(), &NOTHING, lamp, &settings, |_| Ok(())).unwrap())
    });
    assert_eq!(one.figures, two.figures);
    assert!(one.figures.shots > 4 && one.figures.leaf_cells > 100, "{:?}", one.figures);
    for (index, patch) in scene().iter().enumerate() {
        let mut brightest = 0.0_f32;
        for (st, _) in real_points(patch, 24) {
            let bits = |solution: &WaveletSolution| {
                let both = [solution.irradiance(index, st), solution.irradiance_of_emitters(index, st)];
                both.map(|irradiance| irradiance.to_array().map(f32::to_bits))
            };
            assert_eq!(bits(&one), bits(&two));
            brightest = brightest.max(one.irradiance(index, st).x);
        }
        assert!(brightest > 0.01, "{index}: {brightest}");
    }
}

#[test]
fn unshot_power_falls_with_each_shot() {
    let settings = WaveletSettings { max_level: 3, epsilon: 0.1, ..WaveletSettings::default() };
    let mut told = Vec::new();
    let solution = solve(
        &scene(),
        &NOTHING,
        |_, _| Vec3::ZERO,
        &settings,
        |part| {
            told.push(part);
            Ok(())
        },
    );
    let figures = solution.unwrap().figures;
    assert_eq!(told, figures.convergence);
    assert!(told.windows(2).all(|pair| pair[0] < pair[1]), "{told:?}");
    assert!(told[told.len() - 1] >= 0.99 && told[told.len() - 2] < 0.99, "{told:?}");
    let stopped = solve(&scene(), &NOTHING, |_, _| Vec3::ZERO, &settings, |_| Err(Stopped));
    assert_eq!(stopped.map(|_| ()), Err(WaveletError::Stopped(Stopped)));
}

#[test]
fn a_dark_scene_stays_dark() {
    let patches = [flat(DVec3::ZERO, DVec3::Y, vec![circle(1.0)])];
    let solution = solved(&patches, &WaveletSettings::default());
    assert_eq!((solution.figures.shots, solution.figures.cells), (0, 1));
    assert_eq!(solution.irradiance(0, DVec2::splat(0.5)), Vec3::ZERO);
    // No patch at all.
    assert_eq!(solved(&[], &WaveletSettings::default()).figures.cells, 0);
    assert_eq!(solved(&[], &WaveletSettings::default()).irradiance(0, DVec2::ZERO), Vec3::ZERO);
}
