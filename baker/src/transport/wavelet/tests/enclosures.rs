//! Closed rooms of one albedo and emission: radiosity is e / (1 − ρ), so irradiance is too.

use super::*;
use crate::transport::wavelet::{Figures, Order};

const ALBEDO: Vec3 = Vec3::new(0.5, 0.7, 0.2);

/// Half of the sides of the box.
const HALF: Vec3 = Vec3::new(1.0, 1.5, 0.8);

fn furnace(patch: WaveletPatch) -> WaveletPatch {
    WaveletPatch { albedo: ALBEDO, emission: Vec3::new(1.0, 0.5, 2.0), ..patch }
}

/// The greatest error of all irradiance at real points, relative to the closed form.
fn worst_error(solution: &WaveletSolution, patches: &[WaveletPatch]) -> f32 {
    let mut worst = 0.0_f32;
    for (index, patch) in patches.iter().enumerate() {
        let expected = patch.emission / (1.0 - patch.albedo);
        for (st, _) in real_points(patch, 16).into_iter().filter(|(st, _)| patch.mesh.is_real(*st)) {
            let all = solution.irradiance(index, st) + solution.irradiance_of_emitters(index, st);
            let error = ((all - expected) / expected).abs().max_element();
            worst = worst.max(error);
        }
    }
    worst
}

/// Six walls around a box; of one, two halves, and one with a hole that another fills.
fn room() -> Vec<WaveletPatch> {
    let half = HALF.as_dvec3();
    let mut patches = Vec::new();
    for normal in [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z] {
        let origin = -half * normal;
        let frame = Frame::new(origin, normal, normal.any_orthonormal_vector()).unwrap();
        let size = DVec2::new(half.dot(frame.x.abs()), half.dot(frame.y.abs()));
        let wall = |loops| furnace(patch_of(Surface::Plane(frame), false, loops));
        if normal == DVec3::Y {
            let outline = vec![rectangle(-size, size), circle(0.4)];
            patches.extend([wall(outline), wall(vec![circle(0.4)])]);
        } else if normal == DVec3::Z {
            let [a, b] = [DVec2::new(-size.x, -size.y), DVec2::new(size.x, size.y)];
            let [c, d] = [DVec2::new(size.x, -size.y), DVec2::new(-size.x, size.y)];
            patches.extend([wall(vec![polygon(&[a, c, b])]), wall(vec![polygon(&[a, b, d])])]);
        } else {
            patches.push(wall(vec![rectangle(-size, size)]));
        }
    }
    patches
}

#[test]
fn a_box_is_a_furnace() {
    for order in [Order::M1, Order::M2, Order::M3] {
        let settings = WaveletSettings {
            order,
            convergence: 0.9995,
            max_level: 4,
            epsilon: 0.005,
            ..WaveletSettings::default()
        };
        let patches = room();
        let walls = Blockers { room: Some(HALF), ..NOTHING };
        let solution = solve(&patches, &walls, |_, _| Vec3::ZERO, &settings, |_| Ok(())).unwrap();
        let worst = worst_error(&solution, &patches);
        let Figures { convergence, .. } = &solution.figures;
        println!(
            "{order:?} box: worst {worst}, {:?}",
            Figures { convergence: vec![], ..solution.figures.clone() }
        );
        assert!(worst < 0.007, "{order:?}: {worst}");
        assert!(convergence.windows(2).all(|pair| pair[0] < pair[1]), "{convergence:?}");
        assert!(convergence.last().is_some_and(|last| *last >= 0.9995));
    }
}

#[test]
fn the_inside_of_a_sphere_is_constant() {
    for order in [Order::M1, Order::M2, Order::M3] {
        let settings =
            WaveletSettings { order, convergence: 0.9999, epsilon: 0.005, ..WaveletSettings::default() };
        let patches = [furnace(sphere(DVec3::new(1.0, 2.0, 3.0), 1.5, true))];
        let solution = solved(&patches, &settings);
        let worst = worst_error(&solution, &patches);
        println!("{order:?} sphere: worst {worst}, {:?}", solution.figures);
        assert!(worst < 0.005, "{order:?}: {worst}");
        // The first shot alone: the form factor to itself is 1.
        let once = solved(&patches, &WaveletSettings { max_shots: 1, ..settings });
        let found = once.irradiance_of_emitters(0, DVec2::splat(0.4));
        assert!((found / patches[0].emission - 1.0).abs().max_element() < 0.005, "{found}");
        // From outside there is nothing to see.
        let outward = [furnace(sphere(DVec3::ZERO, 1.5, false))];
        let dark = solved(&outward, &settings);
        assert_eq!(dark.irradiance_of_emitters(0, DVec2::splat(0.4)), Vec3::ZERO);
    }
}

/// A sphere from one latitude to another, facing inward, by its natural parameters.
fn natural_zone(latitudes: [f64; 2]) -> WaveletPatch {
    let surface = Surface::Sphere { frame: Frame::default(), radius: 1.5 };
    let zone = rectangle(DVec2::new(0.0, latitudes[0]), DVec2::new(TAU, latitudes[1]));
    let mesh = VirtualMesh::natural(&Face { surface, is_reversed: true, loops: vec![zone] }).unwrap();
    WaveletPatch { mesh: Arc::new(mesh), ..sphere(DVec3::ZERO, 1.5, true) }
}

/// The mean of a patch by area, and the greatest difference from it, on a grid of the square.
fn mean_and_worst(patch: &WaveletPatch, irradiance: impl Fn(DVec2) -> Vec3) -> (Vec3, f32) {
    let points = real_points(patch, 32);
    let area = |st: DVec2, share: f64| (share * patch.mesh.density(st)) as f32;
    let whole: f32 = points.iter().map(|&(st, share)| area(st, share)).sum();
    let mean = points.iter().map(|&(st, share)| area(st, share) * irradiance(st)).sum::<Vec3>() / whole;
    let error = |&(st, _): &(DVec2, f64)| (irradiance(st) / mean - 1.0).abs().max_element();
    (mean, points.iter().map(error).fold(0.0, f32::max))
}

#[test]
fn the_inside_of_a_sphere_is_constant_by_natural_parameters() {
    for order in [Order::M1, Order::M2, Order::M3] {
        let settings =
            WaveletSettings { order, convergence: 0.9999, epsilon: 0.005, ..WaveletSettings::default() };
        let patches = [furnace(natural_zone([-FRAC_PI_2, FRAC_PI_2]))];
        let solution = solved(&patches, &settings);
        let all = |st| solution.irradiance(0, st) + solution.irradiance_of_emitters(0, st);
        let (mean, worst) = mean_and_worst(&patches[0], all);
        println!("{order:?} natural sphere: {mean}, worst {worst}, {:?}", solution.figures);
        let expected = patches[0].emission / (1.0 - patches[0].albedo);
        assert!((mean / expected - 1.0).abs().max_element() < 0.01, "{order:?}: {mean} and {expected}");
        assert!(worst < 0.005, "{order:?}: {worst}");
        // A cap lights all of the sphere by its share of the area.
        let patches = [shining(natural_zone([0.6, FRAC_PI_2])), natural_zone([-FRAC_PI_2, 0.6])];
        let solution = solved(&patches, &settings);
        let (mean, worst) = mean_and_worst(&patches[1], |st| solution.irradiance_of_emitters(1, st));
        let share = (0.5 * (1.0 - 0.6_f64.sine())) as f32;
        println!("{order:?} cap: {mean}, worst {worst}");
        assert!((mean / share - 1.0).abs().max_element() < 0.01, "{order:?}: {mean} and {share}");
        assert!(worst < 0.005, "{order:?}: {worst}");
        // Brightest at the poles: 1/3 in the mean by area, 1/2 by latitude.
        let patches = [WaveletPatch { albedo: ALBEDO, ..natural_zone([-FRAC_PI_2, FRAC_PI_2]) }];
        let lamps = |_: Vec3, normal: Vec3| Vec3::splat(normal.z * normal.z);
        let solution = solve(&patches, &NOTHING, lamps, &settings, |_| Ok(())).unwrap();
        let (mean, worst) = mean_and_worst(&patches[0], |st| solution.irradiance(0, st));
        let expected = ALBEDO / (1.0 - ALBEDO) / 3.0;
        println!("{order:?} poles: {mean}, worst {worst}, {:?}", solution.figures);
        assert!((mean / expected - 1.0).abs().max_element() < 0.01, "{order:?}: {mean} and {expected}");
        assert!(worst < 0.02, "{order:?}: {worst}");
    }
}

#[test]
fn light_of_lamps_is_reflected_but_not_part_of_it() {
    let lit = |patch| WaveletPatch { albedo: ALBEDO, ..patch };
    let patches = [
        lit(flat(DVec3::ZERO, DVec3::Y, vec![circle(1.0)])),
        flat(DVec3::Y, DVec3::NEG_Y, vec![circle(1.0)]),
    ];
    let lamp = |_: Vec3, normal: Vec3| Vec3::new(2.0, 1.0, 0.5) * normal.y.max(0.0);
    let settings = WaveletSettings { epsilon: 0.002, ..WaveletSettings::default() };
    let solution = solve(&patches, &NOTHING, lamp, &settings, |_| Ok(())).unwrap();
    let found = solution.irradiance(1, patches[1].mesh.square(DVec2::ZERO));
    let expected = ALBEDO * Vec3::new(2.0, 1.0, 0.5) * 0.5;
    assert!((found / expected - 1.0).abs().max_element() < 0.005, "{found} {expected}");
    assert_eq!(solution.irradiance(0, patches[0].mesh.square(DVec2::ZERO)), Vec3::ZERO);
    assert_eq!(solution.irradiance_of_emitters(1, DVec2::splat(0.5)), Vec3::ZERO);
    assert_eq!(solution.figures.shooting_patches, 1);
}

/// The room's walls in tiles, more than shoot alone.
fn tiles() -> Vec<WaveletPatch> {
    const SIDE: u32 = 8;
    let half = HALF.as_dvec3();
    let of_wall = |normal: DVec3| {
        let frame = Frame::new(-half * normal, normal, normal.any_orthonormal_vector()).unwrap();
        let size = DVec2::new(half.dot(frame.x.abs()), half.dot(frame.y.abs()));
        (0..SIDE * SIDE).map(move |i| {
            let low = DVec2::new(f64::from(i % SIDE), f64::from(i / SIDE)) / f64::from(SIDE);
            let corner = |at: DVec2| size * (2.0 * at - 1.0);
            let tile = rectangle(corner(low), corner(low + 1.0 / f64::from(SIDE)));
            furnace(patch_of(Surface::Plane(frame), false, vec![tile]))
        })
    };
    [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z]
        .into_iter()
        .flat_map(of_wall)
        .collect()
}

#[test]
#[ignore = "takes much processor time: docs/dev/testing.md"]
fn clusters_are_a_furnace_on_any_number_of_threads() {
    let patches = tiles();
    let settings = WaveletSettings { convergence: 0.999, ..WaveletSettings::default() };
    let walls = Blockers { room: Some(HALF), ..NOTHING };
    let [one, two] = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| solve(&patches, &walls, |_, _| Vec3::ZERO, &settings, |_| Ok(())).unwrap())
    });
    assert_eq!(one.figures, two.figures);
    // Alone each patch would shoot some ten times.
    assert!(one.figures.shots < 3 * patches.len(), "{:?}", one.figures);
    let mut mean = Vec3::ZERO;
    for (index, patch) in patches.iter().enumerate() {
        let at = DVec2::splat(0.4);
        let all = |solution: &WaveletSolution| {
            solution.irradiance(index, at) + solution.irradiance_of_emitters(index, at)
        };
        assert_eq!(all(&one).to_array().map(f32::to_bits), all(&two).to_array().map(f32::to_bits));
        mean += (all(&one) * (1.0 - patch.albedo) / patch.emission) / patches.len() as f32;
    }
    let worst = worst_error(&one, &patches);
    println!(
        "tiles: mean {mean}, worst {worst}, {:?}",
        Figures { convergence: vec![], ..one.figures.clone() }
    );
    assert!((mean - 1.0).abs().max_element() < 0.01, "{mean}");
    assert!(worst < 0.03, "{worst}");
}
