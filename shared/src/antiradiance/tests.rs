//! Laws of light: form factors, reciprocity, occlusion, energy, and both iterations.

use super::*;
use crate::random::Stream;
use glam::Vec3;
use std::f32::consts::PI;
use transfers::Spreading;

/// A square of n by n cells of two triangles; `u` × `v` is the way that it faces.
fn square(middle: Vec3, u: Vec3, v: Vec3, n: usize, albedo: f32) -> Vec<Patch> {
    let normal = u.cross(v).normalize();
    let at = |i: usize, j: usize| middle + (i as f32 / n as f32 - 0.5) * u + (j as f32 / n as f32 - 0.5) * v;
    let mut out = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        let albedo = Vec3::splat(albedo);
        out.push(Patch { corners: [a, b, c], normal, albedo, roughness: None });
        out.push(Patch { corners: [a, c, d], normal, albedo, roughness: None });
    }
    out
}

/// A closed box that faces inwards.
fn room(size: Vec3, n: usize, albedo: f32) -> Vec<Patch> {
    let [x, y, z] = [size.x * Vec3::X, size.y * Vec3::Y, size.z * Vec3::Z];
    let walls = [
        (-0.5 * x, y, z),
        (0.5 * x, z, y),
        (-0.5 * y, z, x),
        (0.5 * y, x, z),
        (-0.5 * z, x, y),
        (0.5 * z, y, x),
    ];
    walls.into_iter().flat_map(|(middle, u, v)| square(middle, u, v, n, albedo)).collect()
}

/// A thin slab of two faces across y.
fn slab(at: f32, half: f32, n: usize) -> Vec<Patch> {
    let (x, z) = (2.0 * half * Vec3::X, 2.0 * half * Vec3::Z);
    let mut out = square(Vec3::new(0.0, at + 0.01, 0.0), z, x, n, 0.0);
    out.extend(square(Vec3::new(0.0, at - 0.01, 0.0), x, z, n, 0.0));
    out
}

fn settings(bins: usize) -> SolverSettings {
    SolverSettings {
        bins,
        width: 1.0,
        tolerance: 0.0,
        iteration: Iteration::Symmetric,
        ..SolverSettings::default()
    }
}

/// Mean irradiance of patches by area.
fn mean(patches: &[Patch], values: &[Vec3], of: impl Fn(&Patch) -> bool) -> f32 {
    let own = || patches.iter().zip(values).filter(|(patch, _)| of(patch));
    let area: f32 = own().map(|(patch, _)| patch.area()).sum();
    own().map(|(patch, value)| patch.area() * value.x).sum::<f32>() / area
}

/// Solves with `lit` patches at irradiance π.
fn solve(patches: &[Patch], settings: &SolverSettings, lit: impl Fn(&Patch) -> bool) -> Vec<Vec3> {
    let direct: Vec<Vec3> =
        patches.iter().map(|patch| if lit(patch) { Vec3::splat(PI) } else { Vec3::ZERO }).collect();
    let solver = AntiradianceSolver::new(patches, settings, &Serial);
    solver.solve(&solver.even_light(direct), settings, &Serial, &mut ()).0
}

#[test]
fn the_form_factor_of_two_parallel_squares_is_the_analytic_one() {
    // Unit squares at distance 1: F = 0.19982 (Howell, configuration C-11).
    for (bins, spreading) in [(128, Spreading::Exact), (512, Spreading::Exact), (512, Spreading::Gaussian)] {
        let mut patches = square(Vec3::ZERO, Vec3::Z, Vec3::X, 8, 1.0);
        patches.extend(square(Vec3::Y, Vec3::X, Vec3::Z, 8, 0.0));
        let settings = SolverSettings { iterations: 1, spreading, ..settings(bins) };
        let found = solve(&patches, &settings, |patch| patch.normal.y > 0.0);
        let factor = mean(&patches, &found, |patch| patch.normal.y < 0.0) / PI;
        // A bin's cosine is that of its middle.
        let most = if spreading == Spreading::Exact { 5.0 / bins as f32 } else { 0.05 };
        assert!((factor / 0.19982 - 1.0).abs() < most, "{factor} with {bins} bins, {spreading:?}");
    }
}

#[test]
fn perpendicular_squares_that_touch_have_the_analytic_form_factor() {
    // F = 0.20004 (Howell, configuration C-14).
    let mut patches = square(Vec3::ZERO, Vec3::Z, Vec3::X, 12, 1.0);
    patches.extend(square(Vec3::new(-0.5, 0.5, 0.0), Vec3::Y, Vec3::Z, 12, 0.0));
    let settings = SolverSettings { iterations: 1, ..settings(512) };
    let found = solve(&patches, &settings, |patch| patch.normal.y > 0.5);
    let factor = mean(&patches, &found, |patch| patch.normal.x > 0.5) / PI;
    assert!((factor / 0.20004 - 1.0).abs() < 0.05, "{factor}");
}

#[test]
fn light_between_two_elements_is_reciprocal() {
    let mut stream = Stream::new(5, 5);
    let mut patches = Vec::new();
    for at in [Vec3::ZERO, Vec3::new(2.0, 1.0, 0.5)] {
        let towards = (Vec3::new(1.0, 0.5, 0.25) - at).normalize();
        patches.extend((0..40).map(|_| {
            let place = at + 0.5 * Vec3::new(stream.unit(), stream.unit(), stream.unit());
            let normal = (towards + 0.4 * stream.sphere()).normalize();
            Patch::around(place, normal, 0.01, Vec3::ONE)
        }));
    }
    let settings = SolverSettings { iterations: 1, ..settings(512) };
    let sent = |from: usize| {
        let direct: Vec<Vec3> =
            (0..80).map(|i| if i / 40 == from { Vec3::splat(PI) } else { Vec3::ZERO }).collect();
        let solver = AntiradianceSolver::new(&patches, &settings, &Serial);
        let (found, _) = solver.solve(&solver.even_light(direct), &settings, &Serial, &mut ());
        let own = (1 - from) * 40..(2 - from) * 40;
        found[own.clone()].iter().zip(&patches[own]).map(|(value, patch)| patch.area() * value.x).sum::<f32>()
    };
    let [there, back] = [sent(0), sent(1)];
    assert!((there / back - 1.0).abs() < 0.03, "{there} {back}");
}

#[test]
fn an_occluder_takes_the_light_away() {
    let floor = |patch: &Patch| patch.normal.y > 0.5 && patch.position().y.abs() < 1e-3;
    let shadowed = |half: f32, bins: usize| {
        let mut patches = square(Vec3::ZERO, Vec3::Z, Vec3::X, 8, 1.0);
        patches.extend(square(2.0 * Vec3::Y, Vec3::X, Vec3::Z, 8, 0.0));
        if half > 0.0 {
            patches.extend(slab(1.0, half, 12));
        }
        let settings = SolverSettings { iterations: 8, ..settings(bins) };
        let found = solve(&patches, &settings, floor);
        mean(&patches, &found, |patch| patch.position().y > 1.5)
    };
    for (bins, most) in [(128, 0.08), (512, 0.05)] {
        let open = shadowed(0.0, bins);
        // A slab as large as the squares covers all of the rays between them.
        let dark = shadowed(0.5, bins);
        assert!(dark.abs() < most * open, "{dark} of {open} with {bins} bins");
    }
    // A slab of half the size in the middle; its share by rays.
    let share = 1.0 - rays_through(0.25);
    for (bins, most) in [(128, 0.15), (512, 0.08)] {
        let left = shadowed(0.25, bins) / shadowed(0.0, bins);
        assert!((left - share).abs() < most, "{left} of {share} with {bins} bins");
    }
}

/// Share of the light between unit squares at distance 2 that goes through a square of `half` half its size in the middle.
fn rays_through(half: f32) -> f32 {
    let mut stream = Stream::new(9, 1);
    let (mut all, mut through) = (0.0f64, 0.0f64);
    for _ in 0..400_000 {
        let (a, b) = (stream.square() - 0.5, stream.square() - 0.5);
        let square = 4.0 + a.distance_squared(b);
        let weight = f64::from(4.0 / (square * square));
        let middle = 0.5 * (a + b);
        all += weight;
        through += if middle.abs().max_element() < half { weight } else { 0.0 };
    }
    (through / all) as f32
}

#[test]
fn a_closed_furnace_holds() {
    // All walls at the same irradiance π and albedo 1/2: bounced irradiance is π (1/2 + 1/4 + …) = π.
    for (bins, size) in [(128, Vec3::ONE), (512, Vec3::new(1.0, 1.5, 2.0))] {
        let patches = room(size, 6, 0.5);
        let found = solve(&patches, &SolverSettings { iterations: 30, ..settings(bins) }, |_| true);
        for (patch, value) in patches.iter().zip(&found) {
            let error = value.x / PI - 1.0;
            assert!(error.abs() < 0.05, "{error} at {} with {bins} bins", patch.position());
        }
    }
}

/// A room with a slab in it, lit at one side.
fn furnished() -> Vec<Patch> {
    let mut patches = room(Vec3::new(2.0, 2.0, 3.0), 5, 0.6);
    for patch in &mut slab(0.1, 0.4, 4) {
        patch.albedo = Vec3::splat(0.5);
        patches.push(*patch);
    }
    patches
}

#[test]
fn all_iterations_agree() {
    let patches = furnished();
    for spreading in [Spreading::Exact, Spreading::Gaussian] {
        let settings = SolverSettings { iterations: 100, spreading, ..settings(128) };
        let by = |iteration| {
            solve(&patches, &SolverSettings { iteration, ..settings }, |patch| patch.normal.y > 0.5)
        };
        let (symmetric, asymmetric) = (by(Iteration::Symmetric), by(Iteration::Asymmetric(5)));
        let solver = AntiradianceSolver::new(&patches, &settings, &Serial);
        let difference = solver.difference(&symmetric, &asymmetric);
        assert!(difference < 1e-3 && mean(&patches, &symmetric, |_| true) > 0.1, "{difference}");
        if spreading == Spreading::Exact {
            let difference = solver.difference(&symmetric, &by(Iteration::Ordered));
            assert!(difference < 1e-3, "{difference}");
        }
    }
}

#[test]
fn the_light_of_two_lamps_is_the_sum_of_both() {
    let patches = furnished();
    let settings = SolverSettings { iterations: 12, ..settings(128) };
    let one = solve(&patches, &settings, |patch| patch.normal.y > 0.5);
    let other = solve(&patches, &settings, |patch| patch.normal.x > 0.5);
    let both = solve(&patches, &settings, |patch| patch.normal.y > 0.5 || patch.normal.x > 0.5);
    for ((one, other), both) in one.iter().zip(&other).zip(&both) {
        assert!((*one + *other - *both).abs().max_element() < 1e-4);
    }
}

#[test]
fn the_ordered_iteration_holds_behind_many_surfaces_where_steps_overshoot() {
    // Twelve sheets behind each other; light comes from the first.
    let sheet = |i: usize| square(0.1 * i as f32 * Vec3::Y, Vec3::X, Vec3::Z, 4, 0.5);
    let mut patches = square(2.0 * Vec3::NEG_Y, 6.0 * Vec3::Z, 6.0 * Vec3::X, 8, 1.0);
    patches.extend((0..12).flat_map(sheet));
    let settings = SolverSettings { iterations: 6, ..settings(128) };
    let lit = |patch: &Patch| patch.normal.y > 0.5;
    let greatest = |iteration| {
        let found = solve(&patches, &SolverSettings { iteration, ..settings }, lit);
        let behind = patches.iter().zip(found).filter(|(patch, _)| patch.position().y > 0.55);
        behind.map(|(_, value)| value.x.abs()).fold(0.0, f32::max) / PI
    };
    let (ordered, symmetric) = (greatest(Iteration::Ordered), greatest(Iteration::Symmetric));
    assert!(ordered < 0.4 && symmetric > 2.0, "{ordered} {symmetric}");
}

#[test]
fn a_metal_throws_its_lobe_on_a_wall() {
    // A metal floor under a beam, and a wall beside it: the light of single reflections is a sum over both.
    let (roughness, count) = (0.5, 10);
    let bins = Bins::new(512);
    let way = bins.directions[bins.bin_of(Vec3::new(0.6, -0.7, 0.1).normalize())];
    let mut patches = square(Vec3::new(-0.6, -0.5, 0.0), Vec3::Z, Vec3::X, count, 1.0);
    patches.iter_mut().for_each(|patch| patch.roughness = Some(roughness));
    let floor = patches.len();
    patches.extend(square(0.5 * Vec3::X, Vec3::Z, Vec3::Y, count, 0.0));
    let settings = SolverSettings { iterations: 1, ..settings(512) };
    let solver = AntiradianceSolver::new(&patches, &settings, &Serial);
    let mut direct = solver.even_light(vec![Vec3::ZERO; patches.len()]);
    direct.by_bin.iter_mut().skip(bins.bin_of(way)).step_by(512).for_each(|light| *light = Vec3::ONE);
    let found = solver.solve(&direct, &settings, &Serial, &mut ()).0;
    let wall = |patch: &Patch| patch.normal.x < -0.5;
    let (alpha, frame) =
        (crate::ggx::alpha(roughness), glam::Mat3::from_cols(Vec3::Z, Vec3::X, Vec3::Y).transpose());
    let reflected = |eye: Vec3| {
        let single = crate::ggx::single_scattering(roughness, eye.y);
        crate::ggx::multiple_scattering(Vec3::ONE, single).x
            * crate::ggx::reflectance(alpha, frame * eye, frame * -way)
    };
    let between = |from: &Patch, to: &Patch| {
        let offset = to.position() - from.position();
        let eye = offset.normalize();
        from.area() * reflected(eye) * eye.dot(from.normal).max(0.0) * -eye.dot(to.normal).min(0.0)
            / offset.length_squared()
    };
    let expected: Vec<Vec3> = patches
        .iter()
        .map(|to| Vec3::splat(patches[..floor].iter().map(|from| between(from, to)).sum()))
        .collect();
    let [found, expected] = [found, expected].map(|light| mean(&patches, &light, wall));
    assert!((found / expected - 1.0).abs() < 0.06 && found > 0.05, "{found} {expected}");
}
