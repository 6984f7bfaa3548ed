//! Probes: the rows' laws, and the GPU's sums against the CPU's.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::pipelines::Pipelines;
use rebounce_viewer::probes::caster::Caster;
use rebounce_viewer::probes::fill::ProbePass;
use rebounce_viewer::probes::grid::Grid;
use rebounce_viewer::probes::harmonics;
use rebounce_viewer::probes::hits::HitPass;
use rebounce_viewer::probes::rows::{Input, Rows, apply};
use rebounce_viewer::probes::sample;
use rebounce_viewer::readback::Readback;
use rebounce_viewer::scene::GpuScene;

/// The scene on the GPU, and the rows of probes at this spacing.
fn probes(gpu: &Gpu, scene: &BakedScene, spacing: f32) -> (GpuScene, Grid, Rows) {
    let pipelines = Pipelines::new(gpu).unwrap();
    let input = Input::of(scene);
    let loaded = pollster::block_on(GpuScene::upload(gpu, pipelines.loaders(), scene.clone())).unwrap();
    let bounds = [scene.meta.bounds_min, scene.meta.bounds_max].map(Vec3::from);
    let grid = Grid::covering(bounds, Some(spacing));
    let caster = Caster::new(&loaded.upload.triangles).unwrap();
    let pass = HitPass::new(gpu, &pipelines.material);
    let mut rows = Rows::default();
    for probe in 0..grid.len() {
        let rays = input.rays(&caster, &grid, probe);
        let shades = pollster::block_on(pass.shades(gpu, &loaded.materials, &[&rays.hits])).unwrap();
        input.append(&mut rows, &grid, probe, &rays, |ray| shades.at(0, ray));
    }
    (loaded, grid, rows)
}

#[test]
fn in_a_room_of_one_reflectance_under_even_light_every_place_gets_that_share_of_it() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[3, 6, 12]);
    scene.meta.sender_levels = 3;
    for material in &mut scene.meta.materials {
        material.base_color = [0.6, 0.4, 0.2, 1.0];
    }
    for point in &mut scene.points {
        point.tint = rebounce_shared::colour::pack_rgb9e5(Vec3::new(1.5, 1.0, 0.5));
    }
    let (_, grid, rows) = probes(&gpu, &scene, 0.5);
    let sent: Vec<Vec3> = scene.points.iter().map(|point| point.tint()).collect();
    let radiance = apply(&rows, &sent, &[]);
    for (place, normal) in
        [(Vec3::ZERO, Vec3::Y), (Vec3::new(0.7, -0.8, 0.9), Vec3::NEG_X), (Vec3::splat(0.99), Vec3::Z)]
    {
        let irradiance = sample::irradiance(&grid, &rows, &radiance, place, normal);
        let error = (irradiance / Vec3::new(0.6, 0.4, 0.2) - 1.0).abs().max_element();
        assert!(error < 0.02, "{place} {normal}: {irradiance}");
    }
}

#[test]
fn the_gpu_sums_what_the_cpu_sums() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[3, 6, 12]);
    common::add_sources(&mut scene);
    let (loaded, grid, rows) = probes(&gpu, &scene, 0.6);
    let pass = ProbePass::new(&gpu);
    let mut made = pass.allocate(&gpu, &loaded, grid);
    pass.upload(&gpu, &loaded, &mut made, &rows);
    let value = |seed: usize| common::random(seed as u32) * 3.0;
    let light: Vec<Vec3> = (0..scene.sender_count())
        .map(|i| Vec3::new(value(3 * i), value(3 * i + 1), value(3 * i + 2)))
        .collect();
    let strengths: Vec<Vec3> = (0..scene.sources.count()).map(|i| Vec3::splat(value(i + 7))).collect();
    let texels: Vec<[f32; 4]> = light.iter().map(|e| e.extend(0.0).to_array()).collect();
    gpu.queue.write_buffer(&loaded.relight.irradiance, 0, bytemuck::cast_slice(&texels));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    pass.fill(&gpu, &mut encoder, &made, &strengths);
    gpu.queue.submit([encoder.finish()]);
    let sent: Vec<Vec3> = light.iter().zip(&scene.points).map(|(e, point)| *e * point.tint()).collect();
    let cpu = apply(&rows, &sent, &strengths);
    let size = cpu.iter().flatten().map(|c| c.abs().max_element()).fold(0.0, f32::max);
    assert!(size > 0.1);
    for texture in [false, true] {
        let read = if texture {
            Readback::texture(&gpu, &made.radiance_texture, 16)
        } else {
            Readback::buffer(&gpu, &made.radiance)
        };
        let gpu: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&pollster::block_on(read.wait()).unwrap());
        for (i, wanted) in cpu.iter().flatten().enumerate() {
            let [r, g, b, _] = gpu[i];
            assert!(
                (Vec3::new(r, g, b) - *wanted).abs().max_element() < 1e-5 * size,
                "{i}: {:?}, not {wanted}",
                gpu[i]
            );
        }
    }
}

#[test]
fn sky_and_emissive_surfaces_shine_on_probes_as_their_radiance_says() {
    let Some(gpu) = common::gpu() else { return };
    // Without the ceiling, under a sky of one radiance.
    let mut scene = common::room(&[3, 6, 12]);
    common::add_sources(&mut scene);
    scene.sources.groups.clear();
    scene.meta.draws.retain(|draw| draw.material != 3);
    for material in &mut scene.meta.materials {
        material.base_color = [0.0, 0.0, 0.0, 1.0];
    }
    let (_, grid, rows) = probes(&gpu, &scene, 2.0);
    assert_eq!(grid.len(), 1);
    let strengths = vec![Vec3::splat(scene.sources.sky_step * 2.0); scene.sources.count()];
    let radiance = apply(&rows, &vec![Vec3::ZERO; scene.sender_count()], &strengths);
    // A square opening of side 2 at distance 1, seen from its axis: the form factor in closed form, four quadrants of a = b = c.
    let quadrant = (1.0 / 2f32.sqrt()) * (1.0 / 2f32.sqrt()).atan() / std::f32::consts::PI;
    let wanted = 4.0 * quadrant * std::f32::consts::PI * 2.0;
    let irradiance = harmonics::irradiance(&radiance[0], Vec3::Y);
    assert!((irradiance.x / wanted - 1.0).abs() < 0.06, "{irradiance}, not {wanted}");
    assert!(harmonics::irradiance(&radiance[0], Vec3::NEG_Y).x < 0.06 * wanted);
}
