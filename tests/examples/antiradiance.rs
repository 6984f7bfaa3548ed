//! Figures of antiradiance on the GPU as a table of Markdown: what Tables 1 and 2 of Dachsbacher et al. 2007 have, and the
//! time of whole steps.
//!
//! `antiradiance [--bins N] [--elements N] [--steps N] [--walker X,Y,Z] SCENE ...`
//!
//! `--walker` puts the walking figure there, and measures what a pose of it takes, with the patches of a draft of the scene.

use anyhow::{Context, Result, anyhow};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use rebounce::bake::{BakeSettings, BakeSolver, Preset, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::scene::Scene;
use rebounce::transport::antiradiance::direct::of_patch;
use rebounce::transport::antiradiance::{AntiradianceSettings, Pool, patches_of};
use rebounce_shared::antiradiance::{
    AntiradianceSolver, Iteration, MovingElements, Patch, PointPatches, SceneTriangle, Serial, SolverSettings,
};
use rebounce_shared::lighting::Lighting;
use rebounce_viewer::antiradiance::{AntiradiancePipelines, GpuAntiradiance};
use rebounce_viewer::gpu::Gpu;
use rebounce_viewer::readback::Readback;
use std::time::Instant;

/// Places of the figure that are measured, and how far apart they are, metres.
const POSES: usize = 8;
const STEP: DVec3 = DVec3::new(0.02, 0.0, 0.1);
/// Patches of the figure at most, as the page has it.
const MOST_OF_FIGURE: usize = 128;

fn main() -> Result<()> {
    let (mut scenes, mut bins, mut elements, mut steps) = (Vec::new(), 128, 18_000, 8u32);
    let mut walker = None;
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().with_context(|| format!("{argument} needs a value"));
        let mut number = || -> Result<usize> {
            let number = value()?;
            number.parse().with_context(|| number)
        };
        match argument.as_str() {
            "--bins" => bins = number()?,
            "--elements" => elements = number()?,
            "--steps" => steps = number()? as u32,
            "--walker" => walker = Some(place(&value()?)?),
            _ => scenes.push(argument),
        }
    }
    let gpu = Gpu::headless().context("no adapter")?;
    let pipelines = AntiradiancePipelines::new(&gpu);
    let (adapter, threads) = (&gpu.adapter, rayon::current_num_threads());
    let settings = |iteration| {
        let solver = SolverSettings {
            bins,
            iteration,
            iterations: steps,
            tolerance: 0.0,
            ..SolverSettings::default()
        };
        AntiradianceSettings { elements, gloss: false, solver }
    };
    if let Some(at) = walker {
        println!("A pose of the walking figure: links on one thread, steps on {adapter}.\n");
        println!("{}", Walk::HEAD);
        for scene in &scenes {
            println!("{}", Walk::new(scene, at, &settings(Iteration::Ordered))?.row(&gpu, &pipelines)?);
        }
        return Ok(());
    }
    println!("Steps on {adapter} and on {threads} threads; links and form factors on those.\n");
    println!(
        "| scene | iteration | bins | elements | links | form factors | links, s | waves | MB | CPU, ms a step | GPU, ms a step | GPU against CPU |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|---|---|");
    for scene in &scenes {
        for iteration in [Iteration::Symmetric, Iteration::Ordered] {
            println!("{}", row(&gpu, &pipelines, scene, &settings(iteration))?);
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
        light.waves()[0],
        light.bytes() as f64 / 1e6,
        1e3 * on_cpu,
        1e3 * on_gpu,
        solver.difference(&found[..patches.len()], &truth),
    ))
}

fn place(text: &str) -> Result<DVec3> {
    let numbers = text.split(',').map(|number| number.parse().with_context(|| text.to_owned()));
    let numbers: Vec<f64> = numbers.collect::<Result<_>>()?;
    <[f64; 3]>::try_from(numbers).map(DVec3::from).map_err(|_| anyhow!("{text} is not X,Y,Z"))
}

/// Patches as the page has them: of the points of a draft, at most so many.
fn patches_of_draft(scene: &Scene, most: usize) -> Result<Vec<Patch>> {
    let mut settings = BakeSettings { solver: BakeSolver::Radiosity, ..BakeSettings::new(Preset::Draft) };
    // Of a small scene even the coarsest level has more.
    settings.place.functions = settings.place.functions.min(8 * most);
    let (baked, _) = bake(scene, &settings.normalised(), &())?;
    let each = |call: &mut dyn FnMut(SceneTriangle)| {
        for (corners, material) in scene.triangles.iter().zip(&scene.triangle_material) {
            let is_two_sided = scene.materials[*material as usize].double_sided;
            let corners = corners.map(|corner| scene.positions[corner as usize]);
            call(SceneTriangle { corners, is_two_sided, roughness: None, moves: false });
        }
    };
    let at = |point: usize| [baked.points[point].position(), baked.points[point].normal()];
    let all = PointPatches::new(&baked, &|_| false, [most, 0], (&each, &at));
    Ok(all.patches(&at))
}

/// The walking figure in a scene.
struct Walk {
    name: String,
    room: Vec<Patch>,
    /// Patches of the figure by place.
    poses: Vec<Vec<Patch>>,
    settings: SolverSettings,
}

impl Walk {
    const HEAD: &str = "| scene | patches that stand | of the figure | links | of the figure | all links, s | links of a pose, ms | ordered, ms | uploaded, ms | waves | of the figure | ms a step |\n\
                        |---|---|---|---|---|---|---|---|---|---|---|---|";

    fn new(name: &str, at: DVec3, settings: &AntiradianceSettings) -> Result<Self> {
        let scene = rebounce::io::load(name)?;
        let room = patches_of_draft(&scene, settings.patches())?;
        let figure = rebounce::io::load("builtin:walker")?;
        let own = patches_of_draft(&figure, MOST_OF_FIGURE)?;
        let pose = |i: usize| -> Vec<Patch> {
            let at = at + i as f64 * STEP;
            let shift = (DVec3::from(figure.origin) + at - DVec3::from(scene.origin)).as_vec3();
            let moved =
                |patch: &Patch| Patch { corners: patch.corners.map(|corner| corner + shift), ..*patch };
            own.iter().map(moved).collect()
        };
        let poses = (0..POSES).map(pose).collect();
        Ok(Self { name: name.to_owned(), room, poses, settings: settings.solver })
    }

    fn row(&self, gpu: &Gpu, pipelines: &AntiradiancePipelines) -> Result<String> {
        let [still, moving] = [self.room.len(), self.poses[0].len()];
        let all = [&self.room[..], &self.poses[0]].concat();
        let began = Instant::now();
        let mut elements = MovingElements::new(all, still, self.settings, &Serial);
        let first = began.elapsed().as_secs_f64();
        let mut light = GpuAntiradiance::of_moving(gpu, pipelines, &elements, &elements.still_tables())?;
        let mut times = [0.0; 4];
        for pose in &self.poses {
            let mut began = Instant::now();
            let mut lap = |i: usize| {
                times[i] += 1e3 * began.elapsed().as_secs_f64() / POSES as f64;
                began = Instant::now();
            };
            elements.follow(pose, &Serial);
            lap(0);
            let tables = elements.moving_tables();
            lap(1);
            light.follow(gpu, pipelines, &elements, &tables)?;
            lap(2);
            read(gpu, &light)?;
            let began = Instant::now();
            let mut encoder = gpu.device.create_command_encoder(&Default::default());
            (0..self.settings.iterations).for_each(|_| light.step(&mut encoder, pipelines));
            gpu.queue.submit([encoder.finish()]);
            read(gpu, &light)?;
            times[3] +=
                1e3 * began.elapsed().as_secs_f64() / (POSES as f64 * f64::from(self.settings.iterations));
        }
        gpu.check()?;
        let [links, of_figure] = elements.links();
        let [waves, own] = light.waves();
        let [linked, ordered, uploaded, step] = times;
        Ok(format!(
            "| `{}` | {still} | {moving} | {links} | {of_figure} | {first:.1} | {linked:.0} | {ordered:.0} | {uploaded:.1} | {waves} | {own} | {step:.0} |",
            self.name
        ))
    }
}

fn read(gpu: &Gpu, light: &GpuAntiradiance) -> Result<Vec<Vec3>> {
    let bytes = pollster::block_on(Readback::buffer(gpu, light.irradiance()).wait())?;
    Ok(bytemuck::cast_slice::<u8, [f32; 4]>(&bytes).iter().map(|cell| Vec3::from_slice(cell)).collect())
}
