//! Figures of antiradiance on the GPU as a table of Markdown: what Tables 1 and 2 of Dachsbacher et al. 2007 have, and the
//! time of whole steps.
//!
//! `antiradiance [--bins N] [--elements N] [--steps N] SCENE ...`

use anyhow::{Context, Result};
use glam::Vec3;
use rayon::prelude::*;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::transport::antiradiance::direct::of_patch;
use rebounce::transport::antiradiance::{AntiradianceSettings, Pool, patches_of};
use rebounce_shared::antiradiance::{AntiradianceSolver, Iteration, SolverSettings};
use rebounce_shared::lighting::Lighting;
use rebounce_viewer::antiradiance::{AntiradiancePipelines, GpuAntiradiance};
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::readback::Readback;
use std::time::Instant;

fn main() -> Result<()> {
    let (mut scenes, mut bins, mut elements, mut steps) = (Vec::new(), 128, 18_000, 8u32);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut number = || -> Result<usize> {
            let number = arguments.next().with_context(|| format!("{argument} needs a number"))?;
            number.parse().with_context(|| number)
        };
        match argument.as_str() {
            "--bins" => bins = number()?,
            "--elements" => elements = number()?,
            "--steps" => steps = number()? as u32,
            _ => scenes.push(argument),
        }
    }
    let gpu = Gpu::headless().context("no adapter")?;
    let pipelines = AntiradiancePipelines::new(&gpu);
    let (adapter, threads) = (&gpu.adapter, rayon::current_num_threads());
    println!("Steps on {adapter} and on {threads} threads; links and form factors on those.\n");
    println!(
        "| scene | iteration | bins | elements | links | form factors | links, s | waves | MB | CPU, ms a step | GPU, ms a step | GPU against CPU |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for scene in &scenes {
        for iteration in [Iteration::Symmetric, Iteration::Ordered] {
            let settings = SolverSettings {
                bins,
                iteration,
                iterations: steps,
                tolerance: 0.0,
                ..SolverSettings::default()
            };
            let settings = AntiradianceSettings { elements, gloss: false, solver: settings };
            println!("{}", row(&gpu, &pipelines, scene, &settings)?);
        }
    }
    Ok(())
}

fn row(
    gpu: &Gpu,
    pipelines: &AntiradiancePipelines,
    name: &str,
    settings: &AntiradianceSettings,
) -> Result<String> {
    let scene = rebounce::io::load(name)?;
    let surfaces = TriangleSurfaces::simplified(&scene);
    let patches = patches_of(&scene, settings.patches(), false);
    let settings = &settings.solver;
    let lamps = Lighting::new(&scene.lights, None, scene.origin, 0).lamps;
    let direct: Vec<Vec3> = patches.par_iter().map(|patch| of_patch(&surfaces, &lamps, patch)).collect();
    let began = Instant::now();
    let solver = AntiradianceSolver::new(&patches, settings, &Pool);
    let linked = began.elapsed().as_secs_f64();
    let began = Instant::now();
    let (truth, _) = solver.solve(&solver.even_light(direct.clone()), settings, &Pool, &mut ());
    let on_cpu = began.elapsed().as_secs_f64() / f64::from(settings.iterations);

    let mut light = GpuAntiradiance::new(gpu, pipelines, &solver, settings.iteration)?;
    light.set_direct(gpu, &solver.even_light(direct));
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    light.restart(&mut encoder);
    gpu.queue.submit([encoder.finish()]);
    read(gpu, &light)?;
    let began = Instant::now();
    for _ in 0..settings.iterations {
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        light.step(&mut encoder, pipelines);
        gpu.queue.submit([encoder.finish()]);
    }
    let found = read(gpu, &light)?;
    let on_gpu = began.elapsed().as_secs_f64() / f64::from(settings.iterations);
    gpu.check()?;
    Ok(format!(
        "| `{name}` | {:?} | {} | {} | {} | {} | {linked:.1} | {} | {:.0} | {:.0} | {:.0} | {:.5} |",
        settings.iteration,
        solver.bins.count(),
        solver.hierarchy.elements.len(),
        solver.links,
        solver.transfers.transfers.len(),
        light.waves(),
        light.bytes() as f64 / 1e6,
        1e3 * on_cpu,
        1e3 * on_gpu,
        solver.difference(&found[..patches.len()], &truth),
    ))
}

fn read(gpu: &Gpu, light: &GpuAntiradiance) -> Result<Vec<Vec3>> {
    let bytes = pollster::block_on(Readback::buffer(gpu, light.irradiance()).wait())?;
    Ok(bytemuck::cast_slice::<u8, [f32; 4]>(&bytes).iter().map(|cell| Vec3::from_slice(cell)).collect())
}
