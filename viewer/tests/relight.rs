//! The GPU's relighting against the CPU's, step by step.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use rebounce_shared::baked::BakedScene;
use rebounce_shared::glam::Vec3;
use rebounce_shared::rbn::LinkMatrix;
use rebounce_shared::relight;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::readback::Readback;
use rebounce_viewer::relight::{Parts, Relight, RelightPipelines};
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
    let mut relight = Relight::new(gpu, &pipelines, &upload, &upload.points, scene);
    relight.set_lanes(gpu, &pipelines, lanes);
    relight.set_strengths(gpu, &strengths(scene));
    let rows: Vec<[f32; 4]> = direct.iter().map(|e| [e.x, e.y, e.z, 0.0]).collect();
    gpu.queue.write_buffer(&relight.irradiance, 0, bytemuck::cast_slice(&rows));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    relight.encode(&mut encoder, &pipelines, None, None);
    gpu.queue.submit([encoder.finish()]);
    [&relight.irradiance, &relight.display].map(|b| floats(gpu, b))
}

/// Runs the steps of a fixed solution on the GPU, from this direct irradiance of lamps; as [`run`].
fn run_solved(
    gpu: &Gpu,
    scene: &BakedScene,
    direct: &[Vec3],
    strengths: &[Vec3],
    parts: Parts,
) -> [Vec<[f32; 4]>; 2] {
    let materials = rebounce_viewer::materials::material_layout(gpu);
    let shadows = ShadowPipelines::new(gpu, &materials);
    let pipelines = RelightPipelines::new(gpu, &shadows.layout);
    let upload = Upload::new(gpu, scene).unwrap();
    let relight = Relight::new(gpu, &pipelines, &upload, &upload.points, scene);
    assert!(relight.is_solved() && relight.has_sources());
    relight.set_parts(gpu, parts);
    relight.set_strengths(gpu, strengths);
    let rows: Vec<[f32; 4]> = direct.iter().map(|e| [e.x, e.y, e.z, 0.0]).collect();
    gpu.queue.write_buffer(&relight.irradiance, 0, bytemuck::cast_slice(&rows));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    relight.encode(&mut encoder, &pipelines, None, None);
    gpu.queue.submit([encoder.finish()]);
    [&relight.irradiance, &relight.display].map(|b| floats(gpu, b).as_chunks().0.to_vec())
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
fn a_scene_without_a_sky_has_no_dispatch_for_one_and_a_lamp_that_moves_none_for_links_of_a_sky() {
    let Some(gpu) = common::gpu() else { return };
    let materials = rebounce_viewer::materials::material_layout(&gpu);
    let shadows = ShadowPipelines::new(&gpu, &materials);
    let pipelines = RelightPipelines::new(&gpu, &shadows.layout);
    let plain = common::room(&[3, 6, 12]);
    let mut under_sky = plain.clone();
    common::add_sources(&mut under_sky);
    // Dispatches of frames from the points' direct light on, with these strengths of the sources.
    let frames = |scene: &BakedScene, all: &[Vec<Vec3>]| -> Vec<usize> {
        let upload = Upload::new(&gpu, scene).unwrap();
        let relight = Relight::new(&gpu, &pipelines, &upload, &upload.points, scene);
        let frame = |strengths: &Vec<Vec3>| {
            relight.set_strengths(&gpu, strengths);
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            let count = relight.encode(&mut encoder, &pipelines, None, None);
            gpu.queue.submit([encoder.finish()]);
            count
        };
        all.iter().map(frame).collect()
    };
    let day = strengths(&under_sky);
    let dusk: Vec<Vec3> = day.iter().map(|strength| *strength * 0.25).collect();
    let levels = plain.meta.levels.len();
    // Pull, send, one coarse level and its bounces, one finer level of senders, send, all levels, light level.
    let own = levels - 1 + 1 + 1 + 1 + 1 + 1 + levels + 1;
    assert_eq!(frames(&plain, &[Vec::new(), Vec::new()]), [own, own]);
    // With sources two sums more; their links only for another sky.
    assert_eq!(frames(&under_sky, &[day.clone(), day, dusk]), [own + 2 + levels, own + 2, own + 2 + levels]);
    gpu.check().unwrap();
}

#[test]
fn groups_of_a_fixed_solution_agree_with_the_cpu_part_by_part() {
    let Some(gpu) = common::gpu() else { return };
    let mut scene = common::room(&[3, 6, 12]);
    common::solve(&mut scene);
    let strengths = [Vec3::new(3.0, 2.0, 0.5), Vec3::ZERO, Vec3::new(0.1, 40.0, 1e3)];
    let light = relight::from_groups(&scene, &strengths);
    let direct = irradiance(scene.direct_count());
    for (bounced, from_sources) in [(true, true), (true, false), (false, true), (false, false)] {
        let parts = Parts { bounced, from_sources };
        let [senders, display] = run_solved(&gpu, &scene, &direct, &strengths, parts);
        let shown =
            |i: usize| light.bounced[i] * f32::from(bounced) + light.direct[i] * f32::from(from_sources);
        let near = |ours: &[f32; 4], truth: Vec3| {
            (Vec3::from_slice(&ours[..3]) - truth).abs().cmple(1e-5 * truth).all()
        };
        let mut lit = 0;
        for (i, ours) in display.iter().take(scene.points.len()).enumerate() {
            assert!(near(ours, shown(i)), "point {i}: {ours:?}, not {}", shown(i));
            // The tilt of light from nowhere in particular (tilt.wgsl).
            assert_eq!(ours[3], 128.0 * (1.0 + 256.0 + 65536.0));
            lit += usize::from(shown(i).min_element() > 0.0);
        }
        assert!(lit > 100 || !bounced && !from_sources, "{lit} points are lit");
        let mut truth: Vec<Vec3> = (0..scene.direct_count()).map(|i| direct[i] + shown(i)).collect();
        relight::pull(&scene, &mut truth);
        for (i, ours) in senders.iter().take(scene.sender_count()).enumerate() {
            assert!(near(ours, truth[i]), "sender {i}: {ours:?}, not {}", truth[i]);
        }
    }
    gpu.check().unwrap();
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
