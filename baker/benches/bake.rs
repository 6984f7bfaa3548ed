//! How far a whole bake is from casting its rays: `cargo xtask bench-bake`, or
//! `cargo bench -p rebounce --bench bake -- SCENE PRESET ROUNDS`.
//!
//! In turns: a bake with two threads; the rays of its gathers, the same ones, one receiver's after another's, on as many
//! threads, with nothing but the walk through the hierarchy to the nearest hit; and a bake with one thread. Medians.

use anyhow::{Context, Result, ensure};
use rayon::prelude::*;
use rebounce::bake::{BakeReport, BakeSettings, Preset, bake, choose_viewpoints};
use rebounce::operator::OperatorSettings;
use rebounce::operator::directions::Directions;
use rebounce::operator::hemisphere::{GatherRays, gather_rays};
use rebounce::operator::refine::CHUNK;
use rebounce::points::{Points, place};
use rebounce::scene::{self, Scene};
use rebounce::surface::Surfaces;
use rebounce::triangles::TriangleSurfaces;
use rebounce_shared::rbn;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Threads of the bake that is compared with its rays.
const THREADS: usize = 2;

fn main() -> Result<()> {
    // Cargo passes --bench itself.
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    let spec = args.first().map_or("builtin:library", String::as_str);
    let preset = match args.get(1).map(String::as_str) {
        None | Some("draft") => Preset::Draft,
        Some("standard") => Preset::Standard,
        Some("fine") => Preset::Fine,
        Some(other) => anyhow::bail!("there is no preset {other}; there are draft, standard and fine"),
    };
    let rounds: usize = args.get(2).map_or(Ok(1), |rounds| rounds.parse()).context("how many rounds?")?;
    let scene = scene::load(spec)?;
    let settings = BakeSettings::new(preset).normalised();
    let (two, one) = (pool(THREADS)?, pool(1)?);
    let (mut bakes, mut walks, mut alone) = (Vec::new(), Vec::new(), Vec::new());
    let mut stages: Vec<(String, Vec<f64>)> = Vec::new();
    let mut rays = None;
    for round in 0..rounds.max(1) {
        let (seconds, file, report) = baked(&scene, &settings, &two)?;
        bakes.push(seconds);
        for (name, seconds) in &report.seconds {
            match stages.iter_mut().find(|stage| stage.0 == *name) {
                Some(stage) => stage.1.push(*seconds),
                None => stages.push((name.clone(), vec![*seconds])),
            }
        }
        let rays = match &rays {
            Some(rays) => rays,
            None => rays.insert(Rays::of(&scene, &settings, &file, &report)?),
        };
        walks.push(two.install(|| rays.walk()));
        alone.push(baked(&scene, &settings, &one)?.0);
        println!(
            "round {round}: {THREADS} threads {:.2} s, rays alone {:.2} s, one thread {:.2} s",
            bakes[round], walks[round], alone[round]
        );
    }
    println!("{:.1} M rays in gathers", rays.map_or(0, |rays| rays.count) as f64 * 1e-6);
    let (bake, walk, alone) = (median(&mut bakes), median(&mut walks), median(&mut alone));
    for (name, seconds) in &mut stages {
        let seconds = median(seconds);
        println!("{name:>16} {seconds:7.2} s {:5.1}%", 100.0 * seconds / bake);
    }
    println!("traversal ratio {:.2}, two threads {:.2}", bake / walk, alone / bake);
    Ok(())
}

fn pool(threads: usize) -> Result<rayon::ThreadPool> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build()?)
}

fn baked(
    scene: &Scene,
    settings: &BakeSettings,
    pool: &rayon::ThreadPool,
) -> Result<(f64, rbn::Scene, BakeReport)> {
    let began = Instant::now();
    let (file, report) = pool.install(|| bake(scene, settings, &()))?;
    Ok((began.elapsed().as_secs_f64(), file, report))
}

fn median(seconds: &mut [f64]) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds.get(seconds.len() / 2).copied().unwrap_or(f64::NAN)
}

/// What it takes to cast a bake's gather rays again.
struct Rays {
    surfaces: TriangleSurfaces,
    points: Points,
    /// Receivers that are gathered for, by level.
    receivers: Vec<Vec<usize>>,
    operator: OperatorSettings,
    count: u64,
}

impl Rays {
    /// Places the bake's points once more, and finds which of them it gathered for.
    fn of(scene: &Scene, settings: &BakeSettings, file: &rbn::Scene, report: &BakeReport) -> Result<Self> {
        let surfaces = TriangleSurfaces::simplified(scene);
        let viewpoints = choose_viewpoints(scene, &surfaces, settings)?;
        let points = place(&surfaces, &viewpoints, &settings.place, &())?;
        ensure!(points.points.len() == file.points.len(), "the same settings placed other points");
        let coarse = points.count_on(settings.operator.later_levels);
        let wanted = |i: &usize| {
            let parents = file.relations.push().row(*i);
            *i < coarse
                || parents.is_empty()
                || parents.iter().any(|parent| !file.links.row(parent.point()).is_empty())
        };
        let receivers: Vec<Vec<usize>> =
            points.levels.iter().map(|level| level.range().filter(wanted).collect()).collect();
        let operator = settings.operator.clone();
        let on = |(l, receivers): (usize, &Vec<usize>)| receivers.len() as u64 * operator.rays_on(l) as u64;
        let count = receivers.iter().enumerate().map(on).sum();
        ensure!(count == report.rays, "{count} rays are not the bake's {}", report.rays);
        Ok(Self { surfaces, points, receivers, operator, count })
    }

    /// Seconds that the walks take on all threads of this pool. Making the rays is not counted.
    fn walk(&self) -> f64 {
        let spent: Duration = self
            .receivers
            .iter()
            .enumerate()
            .map(|(l, receivers)| {
                let directions = Directions::new(self.operator.rays_on(l));
                receivers.par_chunks(CHUNK).map(|chunk| self.walk_for(chunk, &directions)).sum::<Duration>()
            })
            .sum();
        spent.as_secs_f64() / rayon::current_num_threads() as f64
    }

    fn walk_for(&self, chunk: &[usize], directions: &Directions) -> Duration {
        let epsilon = self.surfaces.epsilon();
        let mut rays = GatherRays::default();
        let mut spent = Duration::ZERO;
        for &i in chunk {
            rays.clear();
            gather_rays(&self.points.points[i], i, self.operator.seed, epsilon, directions, &mut rays);
            let began = Instant::now();
            for (ray, seed) in &rays.rays {
                black_box(self.surfaces.distance(ray, *seed));
            }
            spent += began.elapsed();
        }
        spent
    }
}
