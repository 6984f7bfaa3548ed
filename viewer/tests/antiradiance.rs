//! Antiradiance on the GPU against the CPU's, with the same links.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::antiradiance::waves::SLICES;
use rebounce_shared::antiradiance::{
    AntiradianceSolver, Iteration, MovingElements, Patch, Serial, SolverSettings, Spreading,
};
use rebounce_shared::glam::{Quat, Vec3};
use rebounce_viewer::antiradiance::{AntiradiancePipelines, GpuAntiradiance};
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::readback::Readback;

/// A parallelogram of n by n cells of two triangles; `u` × `v` is the way that it faces.
fn wall(middle: Vec3, u: Vec3, v: Vec3, n: usize, albedo: Vec3) -> Vec<Patch> {
    let normal = u.cross(v).normalize();
    let at = |i: usize, j: usize| middle + (i as f32 / n as f32 - 0.5) * u + (j as f32 / n as f32 - 0.5) * v;
    let mut out = Vec::new();
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        out.extend([[a, b, c], [a, c, d]].map(|corners| Patch { corners, normal, albedo, roughness: None }));
    }
    out
}

/// A coloured room of four metres with a slab in it, which hides a part of the ceiling from the floor.
fn room() -> Vec<Patch> {
    let [x, y, z] = [4.0 * Vec3::X, 2.5 * Vec3::Y, 3.0 * Vec3::Z];
    let [white, red, green] = [Vec3::splat(0.7), Vec3::new(0.7, 0.1, 0.1), Vec3::new(0.1, 0.6, 0.1)];
    let mut out = wall(-0.5 * x, y, z, 5, red);
    out.extend(wall(0.5 * x, z, y, 5, green));
    for (middle, u, v) in [(-0.5 * y, z, x), (0.5 * y, x, z), (-0.5 * z, x, y), (0.5 * z, y, x)] {
        out.extend(wall(middle, u, v, 5, white));
    }
    for (height, u, v) in [(0.32, z, x), (0.28, x, z)] {
        out.extend(wall(height * Vec3::Y, 0.4 * u, 0.4 * v, 4, white));
    }
    out
}

/// Direct light on the patches that face one way.
fn lit(patches: &[Patch], way: Vec3, light: Vec3) -> Vec<Vec3> {
    let at = |patch: &Patch| if patch.normal.dot(way) > 0.9 { light } else { Vec3::ZERO };
    patches.iter().map(at).collect()
}

fn read(gpu: &Gpu, light: &GpuAntiradiance) -> Vec<Vec3> {
    let bytes = pollster::block_on(Readback::buffer(gpu, light.irradiance()).wait()).unwrap();
    bytemuck::cast_slice::<u8, [f32; 4]>(&bytes).iter().map(|cell| Vec3::from_slice(cell)).collect()
}

fn steps(gpu: &Gpu, pipelines: &AntiradiancePipelines, light: &mut GpuAntiradiance, count: u32, anew: bool) {
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    if anew {
        light.restart(&mut encoder);
    }
    (0..count).for_each(|_| light.step(&mut encoder, pipelines));
    gpu.queue.submit([encoder.finish()]);
}

#[test]
fn the_gpus_light_is_that_of_the_cpu_with_the_same_links() {
    let Some(gpu) = common::gpu() else { return };
    let pipelines = AntiradiancePipelines::new(&gpu);
    let mut patches = room();
    // The floor and the slab are metal.
    patches.iter_mut().filter(|patch| patch.normal.y > 0.9).for_each(|patch| patch.roughness = Some(0.3));
    for (spreading, iteration, iterations) in [
        (Spreading::Exact, Iteration::Symmetric, 1),
        (Spreading::Exact, Iteration::Symmetric, 12),
        (Spreading::Exact, Iteration::Asymmetric(4), 12),
        (Spreading::Gaussian, Iteration::Symmetric, 12),
        (Spreading::Exact, Iteration::Ordered, 12),
    ] {
        let settings =
            SolverSettings { spreading, iteration, iterations, tolerance: 0.0, ..SolverSettings::default() };
        let solver = AntiradianceSolver::new(&patches, &settings, &Serial);
        let mut light = GpuAntiradiance::new(&gpu, &pipelines, &solver, iteration).unwrap();
        for strength in [1.0, 1e-3, 1e3] {
            let direct = solver.even_light(lit(&patches, Vec3::Y, strength * Vec3::new(3.0, 2.5, 2.0)));
            let (truth, _) = solver.solve(&direct, &settings, &Serial, &mut ());
            light.set_direct(&gpu, &direct);
            steps(&gpu, &pipelines, &mut light, iterations, true);
            let found = read(&gpu, &light);
            let difference = solver.difference(&found[..patches.len()], &truth);
            println!(
                "{spreading:?}, {iteration:?}, {iterations} steps, light of {strength}: {difference:.5}"
            );
            assert!(difference < 0.01, "{spreading:?}, {iteration:?}, {iterations}: {difference}");
        }
        assert_eq!(light.steps(), iterations);
    }
    gpu.check().unwrap();
}

#[test]
fn light_around_what_moves_is_that_of_one_table_of_links() {
    let Some(gpu) = common::gpu() else { return };
    let pipelines = AntiradiancePipelines::new(&gpu);
    let mut patches = room();
    // Floor and slab are metal above; the slab, which is last, moves.
    patches.iter_mut().filter(|patch| patch.normal.y > 0.9).for_each(|patch| patch.roughness = Some(0.3));
    let still = patches.len() - 64;
    let slab = patches[still..].to_vec();
    let placed = |turn: f32, at: Vec3| -> Vec<Patch> {
        let turn = Quat::from_rotation_x(turn);
        let place = |patch: &Patch| Patch {
            corners: patch.corners.map(|corner| turn * corner + at),
            normal: turn * patch.normal,
            ..*patch
        };
        slab.iter().map(place).collect()
    };
    let settings = SolverSettings { iterations: 40, ..SolverSettings::default() };
    // Far away it has few links, so that buffers grow.
    patches[still..].copy_from_slice(&placed(0.0, 40.0 * Vec3::Y));
    let mut elements = MovingElements::new(patches, still, settings, &Serial);
    let far = elements.links()[1];
    let mut light =
        GpuAntiradiance::of_moving(&gpu, &pipelines, &elements, &elements.still_tables()).unwrap();
    let mut before: Option<Vec<Vec3>> = None;
    for (turn, at) in [(0.0, Vec3::ZERO), (0.7, Vec3::new(0.4, 0.2, -0.3)), (2.0, 0.5 * Vec3::NEG_Y)] {
        elements.follow(&placed(turn, at), &Serial);
        light.follow(&gpu, &pipelines, &elements, &elements.moving_tables()).unwrap();
        let near = elements.links()[1];
        assert!(near > 3 * far / 2, "{near} {far}");
        let solver = elements.solver();
        let direct = solver.even_light(lit(solver.patches, Vec3::Y, Vec3::new(3.0, 2.5, 2.0)));
        light.set_direct(&gpu, &direct);
        steps(&gpu, &pipelines, &mut light, 40, false);
        let found = read(&gpu, &light)[..solver.patches.len()].to_vec();
        let (truth, _) = solver.solve(&direct, &settings, &Serial, &mut ());
        let difference = solver.difference(&found, &truth);
        let moved = before.map_or(1.0, |before| solver.difference(&before, &truth));
        println!("turned by {turn}: {difference:.5}, before {moved:.3}");
        assert!(difference < 0.01 && moved > 0.05, "turned by {turn}: {difference}, before {moved}");
        before = Some(found);
    }
    gpu.check().unwrap();
}

#[test]
fn light_where_nothing_moves_is_that_of_one_table_of_links() {
    let Some(gpu) = common::gpu() else { return };
    let pipelines = AntiradiancePipelines::new(&gpu);
    let patches = room();
    let settings = SolverSettings { iterations: 40, ..SolverSettings::default() };
    let elements = MovingElements::new(patches.clone(), patches.len(), settings, &Serial);
    let mut light =
        GpuAntiradiance::of_moving(&gpu, &pipelines, &elements, &elements.still_tables()).unwrap();
    light.follow(&gpu, &pipelines, &elements, &elements.moving_tables()).unwrap();
    let solver = elements.solver();
    let direct = solver.even_light(lit(&patches, Vec3::Y, Vec3::ONE));
    light.set_direct(&gpu, &direct);
    steps(&gpu, &pipelines, &mut light, settings.iterations, true);
    let (truth, _) = solver.solve(&direct, &settings, &Serial, &mut ());
    let difference = solver.difference(&read(&gpu, &light)[..patches.len()], &truth);
    assert!(difference < 0.01 && light.waves()[1] == 0, "{difference}");
    gpu.check().unwrap();
}

#[test]
fn sweeps_hold_behind_many_surfaces() {
    let Some(gpu) = common::gpu() else { return };
    let pipelines = AntiradiancePipelines::new(&gpu);
    // Eight sheets behind each other over a floor that is lit.
    let sheets = (0..8).flat_map(|i| wall(0.15 * i as f32 * Vec3::Y, Vec3::X, Vec3::Z, 4, Vec3::splat(0.5)));
    let mut patches = wall(2.0 * Vec3::NEG_Y, 6.0 * Vec3::Z, 6.0 * Vec3::X, 8, Vec3::ONE);
    patches.extend(sheets);
    let settings = SolverSettings {
        iteration: Iteration::Ordered,
        iterations: 8,
        tolerance: 0.0,
        ..SolverSettings::default()
    };
    let solver = AntiradianceSolver::new(&patches, &settings, &Serial);
    let direct = solver.even_light(lit(&patches, Vec3::Y, Vec3::ONE));
    let (truth, _) = solver.solve(&direct, &settings, &Serial, &mut ());
    let mut light = GpuAntiradiance::new(&gpu, &pipelines, &solver, Iteration::Ordered).unwrap();
    light.set_direct(&gpu, &direct);
    steps(&gpu, &pipelines, &mut light, settings.iterations, true);
    let difference = solver.difference(&read(&gpu, &light)[..patches.len()], &truth);
    let elements = solver.hierarchy.elements.len();
    let [waves, _] = light.waves();
    println!("{difference:.5}; {waves} waves of {elements} elements");
    assert!(difference < 0.01 && waves < elements / 4, "{difference}, {waves} waves");
    gpu.check().unwrap();
}

#[test]
fn light_through_slices_of_the_bins_adds_up_to_that_through_all() {
    let Some(gpu) = common::gpu() else { return };
    let pipelines = AntiradiancePipelines::new(&gpu);
    let patches = room();
    let settings = SolverSettings { iteration: Iteration::Ordered, ..SolverSettings::default() };
    let solver = AntiradianceSolver::new(&patches, &settings, &Serial);
    let mut light = GpuAntiradiance::new(&gpu, &pipelines, &solver, settings.iteration).unwrap();
    light.set_direct(&gpu, &solver.even_light(lit(&patches, Vec3::Y, Vec3::ONE)));
    let mut after = |slices: &[Option<usize>]| {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        light.restart(&mut encoder);
        for slice in slices {
            match slice {
                Some(slice) => light.step_slice(&mut encoder, &pipelines, *slice),
                None => light.step(&mut encoder, &pipelines),
            }
        }
        gpu.queue.submit([encoder.finish()]);
        read(&gpu, &light)[..patches.len()].to_vec()
    };
    let mut sum = vec![Vec3::ZERO; patches.len()];
    for slice in 0..SLICES {
        let part = after(&[Some(slice)]);
        assert!(part.iter().any(|light| light.max_element() > 0.0), "slice {slice} is dark");
        sum.iter_mut().zip(part).for_each(|(sum, light)| *sum += light);
    }
    let once = solver.difference(&sum, &after(&[None]));
    let rounds: Vec<Option<usize>> = (0..20 * SLICES).map(|step| Some(step % SLICES)).collect();
    let often = solver.difference(&after(&rounds), &after(&[None; 20]));
    println!("{once:.6} after one step, {often:.5} after twenty");
    assert!(once < 1e-4 && often < 2e-3, "{once} {often}");
    gpu.check().unwrap();
}

#[test]
fn light_that_changes_goes_on_from_the_light_before() {
    let Some(gpu) = common::gpu() else { return };
    let pipelines = AntiradiancePipelines::new(&gpu);
    let patches = room();
    let settings = SolverSettings { iteration: Iteration::Symmetric, ..SolverSettings::default() };
    let solver = AntiradianceSolver::new(&patches, &settings, &Serial);
    let mut light = GpuAntiradiance::new(&gpu, &pipelines, &solver, settings.iteration).unwrap();
    let mut after = |way: Vec3, count: u32, anew: bool| {
        light.set_direct(&gpu, &solver.even_light(lit(&patches, way, Vec3::ONE)));
        steps(&gpu, &pipelines, &mut light, count, anew);
        read(&gpu, &light)[..patches.len()].to_vec()
    };
    let from_above = after(Vec3::Y, 30, true);
    let anew = after(Vec3::X, 30, true);
    let early = after(Vec3::Y, 1, false);
    let late = after(Vec3::Y, 30, false);
    let [apart, near, same] = [&anew, &early, &late].map(|found| solver.difference(found, &from_above));
    println!("{apart:.4} apart, {near:.4} after a step, {same:.5} after thirty");
    assert!(apart > 0.3 && same < 0.01, "{apart} {same}");
    assert!(near < 0.7 * apart && near > 2.0 * same, "{apart} {near} {same}");
    // Without light it is dark in the end.
    light.set_direct(&gpu, &solver.even_light(vec![Vec3::ZERO; patches.len()]));
    steps(&gpu, &pipelines, &mut light, 60, false);
    let dark = read(&gpu, &light);
    assert!(dark[..patches.len()].iter().all(|value| value.abs().max_element() < 2e-3), "it is not dark");
    gpu.check().unwrap();
}
