//! The GPU's relighting against the CPU's, step by step.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_shared::rbn::LinkMatrix;
use rebounce_shared::relight;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::readback::Readback;
use rebounce_viewer::relight::{Relight, RelightPipelines};
use rebounce_viewer::shadow::ShadowPipelines;
use rebounce_viewer::upload::Upload;

fn floats(gpu: &Gpu, buffer: &wgpu::Buffer) -> Vec<f32> {
    let bytes = pollster::block_on(Readback::buffer(gpu, buffer).wait()).unwrap();
    bytemuck::pod_collect_to_vec(&bytes)
}

/// Runs all steps except the first on the GPU, from this direct irradiance. Returns the senders' irradiance and the
/// light at all points.
fn run(gpu: &Gpu, scene: &BakedScene, direct: &[Vec3], lanes: u32) -> [Vec<f32>; 2] {
    let materials = rebounce_viewer::materials::material_layout(gpu);
    let shadows = ShadowPipelines::new(gpu, &materials);
    let pipelines = RelightPipelines::new(gpu, &shadows.layout);
    let upload = Upload::new(gpu, scene).unwrap();
    let mut relight = Relight::new(gpu, &pipelines, &upload, scene);
    relight.set_lanes(gpu, &pipelines, lanes);
    relight.set_strengths(gpu, &strengths(scene));
    let rows: Vec<[f32; 4]> = direct.iter().map(|e| [e.x, e.y, e.z, 0.0]).collect();
    gpu.queue.write_buffer(&relight.irradiance, 0, bytemuck::cast_slice(&rows));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    relight.encode(&mut encoder, &pipelines, None, None);
    gpu.queue.submit([encoder.finish()]);
    [&relight.irradiance, &relight.display].map(|b| floats(gpu, b))
}

/// Largest difference, over the largest value.
fn relative(gpu: &[f32], cpu: &[f32]) -> f32 {
    assert!(gpu.len() >= cpu.len());
    let largest = cpu.iter().fold(0f32, |m, x| m.max(x.abs()));
    assert!(largest > 0.0, "nothing to compare");
    gpu.iter().zip(cpu).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) / largest
}

/// Strengths of a sky of many colours and of two groups.
fn strengths(scene: &BakedScene) -> Vec<Vec3> {
    let value = |i: usize| common::random(i as u32 ^ 0x77) * 3.0;
    let sky = Box::new(std::array::from_fn(|i| Vec3::new(value(3 * i), value(3 * i + 1), value(3 * i + 2))));
    scene.sources.strengths(Some(&sky), &[Vec3::new(2.0, 1.0, 0.5), Vec3::new(0.3, 0.7, 1.0)])
}

fn irradiance(count: usize) -> Vec<Vec3> {
    let value = |i: usize, k: u32| common::random(i as u32 * 3 + k) * 5.0;
    (0..count).map(|i| Vec3::new(value(i, 0), value(i, 1), value(i, 2))).collect()
}

fn check(gpu: &Gpu, scene: &BakedScene, lanes: u32, tolerance: f32) {
    let direct = irradiance(scene.direct_count());
    let [pulled, values] = run(gpu, scene, &direct, lanes);
    let from_sources = relight::from_sources(scene, &strengths(scene));
    let source = |i: usize| from_sources.get(i).copied().unwrap_or(Vec3::ZERO);
    let direct: Vec<Vec3> = direct.iter().enumerate().map(|(i, e)| *e + source(i)).collect();
    let mut cpu_pulled = direct.clone();
    relight::pull(scene, &mut cpu_pulled);
    relight::add_bounced(scene, &mut cpu_pulled);
    let padded = |rows: &[Vec3]| -> Vec<f32> { rows.iter().flat_map(|v| [v.x, v.y, v.z, 0.0]).collect() };
    let difference = relative(&pulled, &padded(&cpu_pulled));
    assert!(difference < 0.1 * tolerance, "{lanes} lanes: {difference}");
    let shown: Vec<Vec3> =
        relight::relight(scene, direct).into_iter().enumerate().map(|(i, e)| e + source(i)).collect();
    let difference = relative(&values, &padded(&shown));
    println!("{lanes} lanes: {difference:e}");
    assert!(difference < tolerance, "{lanes} lanes: {difference}");
}

#[test]
fn every_step_agrees_with_the_cpu_for_every_split_of_the_rows() {
    let Some(gpu) = common::gpu() else { return };
    let scene = common::room(&[3, 6, 12]);
    for lanes in [1, 8, 16, 64] {
        check(&gpu, &scene, lanes, 1e-4);
    }
}

#[test]
fn light_of_sky_and_emissive_surfaces_agrees_with_the_cpu() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[3, 6, 12]);
    common::add_sources(&mut scene);
    for lanes in [1, 8, 64] {
        check(&gpu, &scene, lanes, 1e-4);
    }
}

#[test]
fn links_that_do_not_fit_one_binding_are_split_and_agree_too() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[3, 6, 12]);
    // Many copies of the same links: over 128 MiB.
    let copies = (150 << 20) / (4 * scene.links.links.len()) + 1;
    let template = scene.clone();
    scene.links = repeated(&template.links, copies);
    // Thousands of single-precision numbers a row, summed in a different order.
    check(&gpu, &scene, 8, 5e-3);
}

/// Every link repeated `copies` times, from the same sender.
fn repeated<L: Copy>(matrix: &LinkMatrix<L>, copies: usize) -> LinkMatrix<L> {
    LinkMatrix {
        offsets: matrix.offsets.iter().map(|offset| offset * copies as u32).collect(),
        links: matrix.links.iter().flat_map(|link| std::iter::repeat_n(*link, copies)).collect(),
    }
}
