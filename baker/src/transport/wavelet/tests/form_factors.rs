//! One shot, against form factors in closed form.

use super::*;
use crate::transport::wavelet::{Order, WaveletError};

fn exact() -> WaveletSettings {
    WaveletSettings { epsilon: 0.002, ..WaveletSettings::default() }
}

/// Mean irradiance of a patch from those that shine.
fn mean(solution: &WaveletSolution, patches: &[WaveletPatch], patch: usize) -> f64 {
    let points = real_points(&patches[patch], 64);
    points.iter().map(|(st, share)| share * f64::from(solution.irradiance_of_emitters(patch, *st).x)).sum()
}

#[test]
fn parallel_disks() {
    for order in [Order::M1, Order::M2, Order::M3] {
        for (near, far, distance) in [(1.0, 1.0, 1.0), (0.5, 2.0, 0.7), (2.0, 0.3, 1.5)] {
            let patches = [
                shining(flat(DVec3::ZERO, DVec3::Y, vec![circle(near)])),
                flat(distance * DVec3::Y, DVec3::NEG_Y, vec![circle(far)]),
            ];
            let solution = solved(&patches, &WaveletSettings { order, ..exact() });
            // From the second to the first (Howell, C-41).
            let [a, b] = [far / distance, near / distance];
            let x: f64 = 1.0 + (1.0 + b * b) / (a * a);
            let expected = 0.5 * (x - (x * x - 4.0 * (b / a).powi(2)).sqrt());
            let found = mean(&solution, &patches, 1);
            println!("{order:?} disks {near} {far} {distance}: {found} and {expected}");
            assert!((found / expected - 1.0).abs() < 0.005, "{order:?}: {found} and {expected}");
            assert_eq!(solution.figures.shots, 1);
            assert_eq!(mean(&solution, &patches, 0), 0.0);
        }
    }
}

#[test]
fn a_disk_shines_on_a_sphere() {
    let distance = 2.0;
    let patches =
        [shining(flat(DVec3::ZERO, DVec3::Y, vec![circle(1.0)])), sphere(distance * DVec3::Y, 0.5, false)];
    let solution = solved(&patches, &exact());
    // From the sphere to the disk: half of the solid angle's part of a whole sphere, whatever the sphere's
    // radius.
    let expected = 0.5 * (1.0 - 1.0 / (1.0 + (1.0 / distance).powi(2)).sqrt());
    let found = mean(&solution, &patches, 1);
    println!("sphere to disk: {found} and {expected}");
    assert!((found / expected - 1.0).abs() < 0.005, "{found} and {expected}");
}

#[test]
fn a_sphere_shines_on_a_polygon_with_a_hole() {
    let [radius, height] = [0.5, 1.2];
    let corners = [[-2.0, -2.0], [2.0, -2.0], [2.0, 0.5], [0.5, 0.5], [0.5, 2.0], [-2.0, 2.0]];
    let outline = polygon(&corners.map(DVec2::from));
    let hole = rectangle(DVec2::new(-1.6, -1.5), DVec2::new(-0.9, -0.2));
    for order in [Order::M1, Order::M2, Order::M3] {
        let patches = [
            flat(DVec3::ZERO, DVec3::Y, vec![outline.clone(), hole.clone()]),
            shining(sphere(height * DVec3::Y, radius, false)),
        ];
        let settings = WaveletSettings { order, max_level: 7, ..exact() };
        let solution = solved(&patches, &settings);
        let closed_form = |st: DVec2| {
            let to_centre = height * DVec3::Y - patches[0].mesh.point(st);
            (radius / to_centre.length()).powi(2) * to_centre.normalize().y
        };
        let brightest = (radius / height).powi(2);
        let (mut worst, mut expected) = (0.0_f64, 0.0);
        for (st, share) in real_points(&patches[0], 40) {
            let found = f64::from(solution.irradiance_of_emitters(0, st).x);
            if patches[0].mesh.is_real(st) {
                worst = worst.max((found - closed_form(st)).abs() / brightest);
            }
            expected += share * closed_form(st);
        }
        let found = mean(&solution, &patches, 0);
        println!("{order:?} polygon: {found} and {expected}, worst {worst}, {:?}", solution.figures);
        assert!((found / expected - 1.0).abs() < 0.005, "{order:?}: {found} and {expected}");
        // The oracle's; control points do not reach the rims of cells.
        let area = patches.iter().map(|patch| patch.mesh.real_area()).sum::<f64>();
        let tolerance = settings.epsilon * (patches[1].mesh.area() / area + brightest);
        assert!(worst * brightest < 4.0 * tolerance, "{order:?}: {worst}");
    }
}

#[test]
fn a_disk_in_between_darkens_the_middle() {
    let patches = [
        shining(flat(2.0 * DVec3::Y, DVec3::NEG_Y, vec![circle(1.0)])),
        flat(DVec3::ZERO, DVec3::Y, vec![rectangle(DVec2::NEG_ONE, DVec2::new(1.1, 1.05))]),
    ];
    let settings = WaveletSettings { max_level: 6, ..exact() };
    let blocker = Blockers { disk: Some((1.0, 0.25)), ..NOTHING };
    let solution = solve(&patches, &blocker, |_, _| Vec3::ZERO, &settings, |_| Ok(())).unwrap();
    // sin² of the half angles of the light and of what hides it, seen from the middle: 1 / (1 + 4) and 1 / (1
    // + 16).
    let found = solution.irradiance_of_emitters(1, patches[1].mesh.square(DVec2::ZERO)).x;
    let expected = 1.0 / 5.0 - 1.0 / 17.0;
    println!("shadow: {found} and {expected}, {} rays", solution.figures.rays);
    assert!((found / expected - 1.0).abs() < 0.02, "{found} and {expected}");
}

#[test]
fn sides_and_transforms() {
    let base = [
        shining(flat(DVec3::Y, DVec3::NEG_Y, vec![circle(1.0)])),
        flat(DVec3::ZERO, DVec3::Y, vec![circle(1.0)]),
        WaveletPatch { is_back: true, ..flat(DVec3::ZERO, DVec3::NEG_Y, vec![circle(1.0)]) },
        WaveletPatch { is_back: true, ..flat(DVec3::ZERO, DVec3::Y, vec![circle(1.0)]) },
    ];
    let middle = |solution: &WaveletSolution, patch: usize| {
        solution.irradiance_of_emitters(patch, base[patch].mesh.square(DVec2::ZERO)).x
    };
    let solution = solved(&base, &exact());
    assert!((middle(&solution, 1) - 0.5).abs() < 0.0025, "{}", middle(&solution, 1));
    assert!((middle(&solution, 2) - 0.5).abs() < 0.0025, "{}", middle(&solution, 2));
    assert_eq!(middle(&solution, 3), 0.0);
    // Moved, turned, larger, and mirrored: the same light.
    let turn = glam::DQuat::from_scaled_axis(DVec3::new(0.3, 1.0, -0.4));
    for scale in [DVec3::splat(3.0), DVec3::new(0.2, -0.2, 0.2)] {
        let world_from_part =
            DAffine3::from_scale_rotation_translation(scale, turn, DVec3::new(1.0, 2.0, 3.0));
        let moved = base.clone().map(|patch| WaveletPatch { world_from_part, ..patch });
        let again = solved(&moved, &exact());
        for patch in 0..4 {
            let [before, after] = [middle(&solution, patch), middle(&again, patch)];
            assert!((before - after).abs() < 1e-4, "{scale} {patch}: {before} {after}");
        }
    }
    // A plane may be stretched, a sphere may not.
    let stretch = DAffine3::from_scale(DVec3::new(1.0, 2.0, 1.0));
    let with = |patch: WaveletPatch| {
        let patches = [WaveletPatch { world_from_part: stretch, ..patch }];
        solve(&patches, &NOTHING, |_, _| Vec3::ZERO, &exact(), |_| Ok(())).map(|_| ())
    };
    assert_eq!(with(base[0].clone()), Ok(()));
    assert_eq!(with(sphere(DVec3::ZERO, 1.0, false)), Err(WaveletError::Transform { patch: 0 }));
    let odd = WaveletPatch { albedo: Vec3::splat(1.1), ..base[1].clone() };
    assert_eq!(with(odd), Err(WaveletError::Material { patch: 0 }));
}
