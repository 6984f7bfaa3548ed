//! Figures of radiosity as tables of Markdown, for `cargo xtask bench-radiosity`:
//!
//! `radiosity [--functions N] SCENE ...`
//!
//! Solutions of each scene on the CPU and the GPU, in the ways of Schäfer et al. 2011 and in ours; then the vase of
//! `tests/src/vase.rs` with and without a reconstruction group (Lehtinen et al. 2007, 6.1).

use anyhow::{Context, Result};
use glam::Vec3;
use rayon::prelude::*;
use rebounce::bake::{BakeReport, BakeSettings, BakeSolver, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::light::direct::at_footprint;
use rebounce::light::illumination::Illumination;
use rebounce::scene::Scene;
use rebounce::verify::expose::Exposure;
use rebounce::verify::path_trace::{Settings, path_trace};
use rebounce::verify::render::render;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::LightSource;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::motion::Motions;
use rebounce_shared::radiosity::solver::{Passes, Scene as Solved, Solution};
use rebounce_shared::radiosity::{Accelerator, RadiositySettings, Reconstruction, solve};
use rebounce_shared::relight;
use rebounce_tests::vase;
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::gpu::scope::Scope;
use rebounce_viewer::radiosity::{Radiosity, RadiosityPipelines};
use rebounce_viewer::readback::Readback;
use rebounce_viewer::upload::Upload;
use std::time::Instant;
use wgpu::BufferUsages;

/// Receivers of a slice on the GPU.
const SLICE: u32 = 1 << 13;
/// Pictures of the vase: pixels, and paths a pixel.
const SIZE: [u32; 2] = [128, 96];
const PATHS: u32 = 256;
const SAMPLES: u32 = 32;

fn main() -> Result<()> {
    let (mut scenes, mut functions) = (Vec::new(), None);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--functions" => {
                functions = Some(arguments.next().context("--functions needs a number")?.parse()?)
            }
            _ => scenes.push(argument),
        }
    }
    println!("## Solutions\n");
    println!(
        "Functions of all levels; gathers (gathering integrals) of a solution; seconds of the CPU\n\
         and of the GPU ({}).\n\
         Difference: relative RMS at the points of the finest level from the exact evaluation of as\n\
         many bounces, every bounce on all levels.\n",
        Gpu::headless().map_or("none".to_owned(), |gpu| gpu.adapter.clone())
    );
    println!(
        "| scene | functions | bounces | passes | light at hits | gathers | CPU, s | GPU, s | difference | GPU against CPU |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for scene in &scenes {
        solutions(scene, functions)?;
    }
    println!("\n## A group of its own\n");
    println!(
        "A fluted vase on a plinth, lit by a lamp. Bounced light against path-traced pictures, from near\n\
         the vase and of the room: relative RMS, without the noise of the path tracer (two pictures of\n\
         {PATHS} paths a pixel, independent of each other).\n"
    );
    println!("| bake | functions | links | bytes | seconds | error, vase | error, room |");
    println!("|---|---|---|---|---|---|---|");
    groups(functions.unwrap_or(12_000))
}

/// Direct light of all points.
fn direct(scene: &BakedScene) -> Result<Vec<Vec3>> {
    let surfaces = TriangleSurfaces::from_moved(scene, &Motions::default())?;
    let lamps = Lighting::new(&scene.meta.lights, None, scene.meta.origin, 0).lamps;
    let mut out: Vec<Vec3> =
        scene.points.par_iter().map(|point| at_footprint(&surfaces, &lamps, point)).collect();
    relight::pull(scene, &mut out);
    Ok(out)
}

fn on_cpu(scene: &BakedScene, settings: &RadiositySettings, direct: &[Vec3]) -> (Solution, f64) {
    let accelerator = Accelerator::new(scene);
    let motions = Motions::default();
    let solved = Solved { baked: scene, accelerator: &accelerator, motions: &motions };
    let begun = Instant::now();
    let solution = solve(solved, settings, direct, &|receivers, gather| {
        receivers.par_iter().map(|receiver| gather(*receiver)).collect()
    });
    (solution, begun.elapsed().as_secs_f64())
}

fn on_gpu(
    gpu: &Gpu,
    scene: &BakedScene,
    settings: &RadiositySettings,
    direct: &[Vec3],
) -> Result<(Vec<Vec3>, f64)> {
    let pipelines = RadiosityPipelines::new(gpu);
    let upload = Upload::new(gpu, scene)?;
    let own = Scope::new(gpu);
    let usage = BufferUsages::STORAGE | BufferUsages::COPY_SRC | BufferUsages::COPY_DST;
    let stored = |bytes: &[u8]| {
        let size = bytes.len() as u64;
        let buffer =
            own.buffer(&wgpu::BufferDescriptor { label: None, size, usage, mapped_at_creation: false });
        gpu.queue.write_buffer(&buffer, 0, bytes);
        buffer
    };
    let rows: Vec<[f32; 4]> = direct.iter().map(|e| [e.x, e.y, e.z, 0.0]).collect();
    let points = stored(bytemuck::cast_slice(&scene.points));
    let [given, display] = [stored(bytemuck::cast_slice(&rows)), stored(bytemuck::cast_slice(&rows))];
    let mut solver = Radiosity::new(gpu, &pipelines, &upload, scene, [&points, &given, &display], *settings)?;
    let wait = || pollster::block_on(Readback::buffer(gpu, &display).wait());
    wait()?;
    let begun = Instant::now();
    while !solver.progress().is_done {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        solver.encode(gpu, &mut encoder, &pipelines, SLICE);
        gpu.queue.submit([encoder.finish()]);
    }
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    solver.show(gpu, &mut encoder, &pipelines);
    gpu.queue.submit([encoder.finish()]);
    let bytes = wait()?;
    let seconds = begun.elapsed().as_secs_f64();
    let rows: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
    Ok((rows[..scene.points.len()].iter().map(|[r, g, b, _]| Vec3::new(*r, *g, *b)).collect(), seconds))
}

/// Relative RMS difference.
fn difference(ours: &[Vec3], theirs: &[Vec3]) -> f64 {
    let squares =
        |values: &mut dyn Iterator<Item = Vec3>| values.map(|v| f64::from(v.length_squared())).sum::<f64>();
    let off = squares(&mut ours.iter().zip(theirs).map(|(a, b)| *a - *b));
    (off / squares(&mut theirs.iter().copied())).sqrt()
}

fn baked(scene: &Scene, solver: BakeSolver, functions: Option<usize>) -> Result<(BakedScene, BakeReport)> {
    let mut settings = BakeSettings::new(Preset::Draft);
    settings.solver = solver;
    if let Some(functions) = functions {
        settings.place.functions = functions;
    }
    Ok(bake(scene, &settings.normalised(), &())?)
}

fn solutions(name: &str, functions: Option<usize>) -> Result<()> {
    let (scene, _) = baked(&rebounce::io::load(name)?, BakeSolver::Radiosity, functions)?;
    let (direct, gpu) = (direct(&scene)?, Gpu::headless().ok());
    let finest = scene.display();
    for bounces in [3, 6] {
        let mut exact: Option<Vec<Vec3>> = None;
        for (passes, reconstruction) in [
            (Passes::EachBounce, Reconstruction::Exact),
            (Passes::EachBounce, Reconstruction::Nearest),
            (Passes::Summed, Reconstruction::Exact),
            (Passes::Summed, Reconstruction::Nearest),
        ] {
            let settings =
                RadiositySettings { bounces, passes, reconstruction, ..RadiositySettings::default() };
            let (solution, seconds) = on_cpu(&scene, &settings, &direct);
            let on_gpu = gpu.as_ref().map(|gpu| on_gpu(gpu, &scene, &settings, &direct)).transpose()?;
            let ours = &solution.irradiance[finest.clone()];
            let off = exact.as_ref().map_or(0.0, |exact| difference(ours, exact));
            let passes = if passes == Passes::EachBounce { "each bounce" } else { "summed" };
            let hits = if reconstruction == Reconstruction::Exact { "exact" } else { "nearest" };
            let (gpu_seconds, apart) =
                on_gpu.map_or(("–".to_owned(), "–".to_owned()), |(values, seconds)| {
                    (format!("{seconds:.1}"), format!("{:.1e}", difference(&values[finest.clone()], ours)))
                });
            println!(
                "| {name} | {} | {bounces} | {passes} | {hits} | {} | {seconds:.2} | {gpu_seconds} | {off:.4} | {apart} |",
                scene.points.len(),
                solution.gathers
            );
            if exact.is_none() {
                exact = Some(ours.to_vec());
            }
        }
    }
    Ok(())
}

/// Relative RMS difference from the mean of what two independent pictures estimate.
fn error_without_noise(ours: &[Vec3], [a, b]: &[Vec<Vec3>; 2]) -> f64 {
    let (mut off, mut power) = (0.0, 0.0);
    for ((x, a), b) in ours.iter().zip(a).zip(b) {
        off += f64::from((*x - *a).dot(*x - *b));
        power += f64::from(a.dot(*b));
    }
    (off.max(0.0) / power).sqrt()
}

/// Path-traced bounced light of a camera.
fn truth(scene: &Scene, camera: &Camera, seed: u64) -> Vec<Vec3> {
    let surfaces = TriangleSurfaces::from_scene(scene);
    let lights: Vec<LightSource> = scene.lights.iter().map(|light| light.source(scene.origin)).collect();
    let illumination = Illumination::new(&surfaces, &lights);
    let exposure = Exposure { size: SIZE, samples: PATHS, seed };
    let settings = Settings { only: Only::Indirect, ..Settings::default() };
    path_trace(&surfaces, scene.origin, camera, &illumination, exposure, settings, || ()).pixels
}

fn groups(functions: usize) -> Result<()> {
    let cameras = [vase::near(), vase::room_camera()];
    let plain = vase::scene(None)?;
    let truths = cameras.each_ref().map(|camera| [5, 6].map(|seed| truth(&plain, camera, seed)));
    let cases = [
        ("no group", None, functions),
        ("vase four times finer", Some(4.0), functions),
        ("vase sixteen times finer", Some(16.0), functions),
        ("no group, all twice as fine", None, 2 * functions),
        ("no group, all four times finer", None, 4 * functions),
    ];
    for (name, density, functions) in cases {
        let scene = vase::scene(density)?;
        let begun = Instant::now();
        let (file, report) = baked(&scene, BakeSolver::Operator, Some(functions))?;
        let seconds = begun.elapsed().as_secs_f64();
        let surfaces = TriangleSurfaces::from_moved(&file, &Motions::default())?;
        let error = |i: usize| {
            let exposure = Exposure { size: SIZE, samples: SAMPLES, seed: 7 };
            let lights = &file.meta.lights;
            let picture = render(&file, &surfaces, &cameras[i], lights, exposure, Only::Indirect, || ());
            error_without_noise(&picture.pixels, &truths[i])
        };
        println!(
            "| {name} | {} | {} | {} | {seconds:.1} | {:.4} | {:.4} |",
            report.functions,
            report.links,
            file.to_bytes()?.len(),
            error(0),
            error(1)
        );
    }
    Ok(())
}
