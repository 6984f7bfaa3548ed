//! Orders of convergence, and the same result on any number of threads.

use super::*;
use crate::job::watch::Stopped;
use crate::transport::wavelet::{Order, WaveletError};

#[test]
fn errors_fall_with_the_order_of_the_basis() {
    let [radius, height] = [0.5, 1.2];
    let patches = [
        flat(DVec3::ZERO, DVec3::Y, vec![rectangle(DVec2::new(-0.9, -0.7), DVec2::new(1.0, 1.1))]),
        shining(sphere(height * DVec3::Y, radius, false)),
    ];
    let error = |order: Order, level: u32| {
        let settings = WaveletSettings {
            order,
            epsilon: 1e-5,
            min_level: level,
            max_level: level,
            max_emitter_level: 6,
            ..WaveletSettings::default()
        };
        let solution = solved(&patches, &settings);
        let points = real_points(&patches[0], 48);
        let square: f64 = points
            .iter()
            .map(|&(st, share)| {
                let to_centre = height * DVec3::Y - patches[0].mesh.point(st);
                let exact = (radius / to_centre.length()).powi(2) * to_centre.normalize().y;
                share * (f64::from(solution.irradiance_of_emitters(0, st).x) - exact).powi(2)
            })
            .sum();
        square.sqrt()
    };
    let errors = [Order::M1, Order::M2, Order::M3].map(|order| [1, 2, 3].map(|level| error(order, level)));
    println!("{errors:?}");
    for level in 0..3 {
        assert!(errors[1][level] < 0.5 * errors[0][level] && errors[2][level] < 0.5 * errors[1][level]);
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
