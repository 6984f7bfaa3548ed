//! Time of a complete bake compared with the time of casting its rays: `cargo xtask bench-bake`, or
//! `cargo bench -p rebounce-benches --bench bake -- SCENE PRESET ROUNDS`.
//!
//! A round measures a bake with two threads; the same bake's rays on two threads, traversal only;
//! and a bake with one thread. Results are medians over rounds. The rays are the gather rays,
//! receiver by receiver, and the rays of point placement, clip planes and tints, in their original
//! order; all cast individually. A bake casts gather rays in packets, so packets are timed as well.

use anyhow::{Context, Result, ensure};
use glam::Vec3;
use rayon::prelude::*;
use rebounce::bake::{BakeReport, BakeSettings, Preset, bake, choose_emitter};
use rebounce::basis::relate;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Hit, Ray, Surfaces};
use rebounce::sampling::{Points, cut, footprint, place};
use rebounce::scene::Scene;
use rebounce::transport::direct_to_indirect::OperatorSettings;
use rebounce::transport::direct_to_indirect::directions::Directions;
use rebounce::transport::direct_to_indirect::gather::receivers_together;
use rebounce::transport::direct_to_indirect::gather_batch::BATCH;
use rebounce::transport::direct_to_indirect::hemisphere::{GatherRays, gather_rays};
use rebounce::transport::direct_to_indirect::ray_sort::sort;
use rebounce::transport::direct_to_indirect::{mean_albedo::reflected_share, tint::tints};
use rebounce::transport::direct_to_indirect::{refine::Refiner, senders::Senders};
use std::hint::black_box;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Threads of the bake that is compared with its rays.
const THREADS: usize = 2;

fn main() -> Result<()> {
    // Cargo passes --bench as an argument.
    let args: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    let spec = args.first().map_or("builtin:library", String::as_str);
    let preset = match args.get(1).map(String::as_str) {
        None | Some("draft") => Preset::Draft,
        Some("standard") => Preset::Standard,
        Some("fine") => Preset::Fine,
        Some(other) => anyhow::bail!("there is no preset {other}; there are draft, standard and fine"),
    };
    let rounds: usize = args.get(2).map_or(Ok(1), |rounds| rounds.parse()).context("how many rounds?")?;
    let scene = rebounce::io::load(spec)?;
    let settings = BakeSettings::new(preset).normalised();
    let (two, one) = (pool(THREADS)?, pool(1)?);
    let [mut bakes, mut gathers, mut together, mut others, mut alone] = [const { Vec::new() }; 5];
    let mut stages: Vec<(String, Vec<f64>)> = Vec::new();
    let mut rays = None;
    for round in 0..rounds.max(1) {
        let (seconds, report) = baked(&scene, &settings, &two)?;
        bakes.push(seconds);
        for (name, seconds) in &report.seconds {
            match stages.iter_mut().find(|stage| stage.0 == *name) {
                Some(stage) => stage.1.push(*seconds),
                None => stages.push((name.clone(), vec![*seconds])),
            }
        }
        let rays = match &rays {
            Some(rays) => rays,
            None => rays.insert(two.install(|| Rays::of(&scene, &settings, &report))?),
        };
        gathers.push(two.install(|| rays.walk(Rays::walk_for)));
        together.push(two.install(|| rays.walk(Rays::walk_together_for)));
        others.push(two.install(|| rays.others.walk(&rays.surfaces)));
        alone.push(baked(&scene, &settings, &one)?.0);
        println!(
            "round {round}: {THREADS} threads {:.2} s, rays alone {:.2} s in gathers ({:.2} together) and {:.2} s others, one \
             thread {:.2} s",
            bakes[round], gathers[round], together[round], others[round], alone[round]
        );
    }
    if let Some(rays) = &rays {
        let millions = |count: u64| count as f64 * 1e-6;
        println!(
            "{:.1} M rays in gathers, {:.1} M others",
            millions(rays.count),
            millions(rays.others.count())
        );
    }
    let (bake, alone) = (median(&mut bakes), median(&mut alone));
    let (gather, other) = (median(&mut gathers), median(&mut others));
    for (name, seconds) in &mut stages {
        let seconds = median(seconds);
        println!("{name:>16} {seconds:7.2} s {:5.1}%", 100.0 * seconds / bake);
    }
    println!("over the rays of gathers alone {:.2}", bake / gather);
    println!("over all rays, those of gathers cast together {:.2}", bake / (median(&mut together) + other));
    println!("traversal ratio {:.2}, two threads {:.2}", bake / (gather + other), alone / bake);
    Ok(())
}

fn pool(threads: usize) -> Result<rayon::ThreadPool> {
    Ok(rayon::ThreadPoolBuilder::new().num_threads(threads).build()?)
}

fn baked(scene: &Scene, settings: &BakeSettings, pool: &rayon::ThreadPool) -> Result<(f64, BakeReport)> {
    let began = Instant::now();
    let (_, report) = pool.install(|| bake(scene, settings, &()))?;
    Ok((began.elapsed().as_secs_f64(), report))
}

fn median(seconds: &mut [f64]) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds.get(seconds.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Data for casting a bake's gather rays again.
struct Rays {
    surfaces: TriangleSurfaces,
    points: Points,
    /// Receivers that are gathered for, by level.
    receivers: Vec<Vec<usize>>,
    operator: OperatorSettings,
    count: u64,
    /// Rays outside gathers.
    others: Asked,
}

impl Rays {
    /// Places the bake's points again, and computes its links, which determine the gathered
    /// receivers.
    fn of(scene: &Scene, settings: &BakeSettings, report: &BakeReport) -> Result<Self> {
        let surfaces = TriangleSurfaces::simplified(scene);
        let emitter = choose_emitter(scene, &surfaces, settings)?;
        let recorder = Recorder::new(&surfaces);
        let mut points = place(&recorder, &emitter, &settings.place, &())?;
        let end = points.points.len();
        cut(&recorder, &mut points, end, &())?;
        footprint(&recorder, &mut points, end, &())?;
        let mut operator = settings.operator.clone();
        operator.reflected = reflected_share(&recorder, &points, 0, operator.seed);
        let tints = tints(&recorder, &points, operator.seed);
        let others = recorder.asked();
        let relations = relate(&points, settings.direct_levels)?;
        let senders = Senders::unwatched(&surfaces, &points, &operator, &tints);
        let mut refiner = Refiner::new(&surfaces, &points, &relations, &operator, &senders, tints);
        let mut receivers = Vec::new();
        for _ in &points.levels {
            receivers.push(refiner.receivers_ahead());
            refiner.level();
        }
        let count = refiner.finish().rays;
        ensure!(count == report.rays, "{count} rays are not the bake's {}", report.rays);
        Ok(Self { surfaces, points, receivers, operator, count, others })
    }

    /// Traversal time in seconds on the threads of this pool. Generating and sorting the rays is
    /// not timed.
    fn walk(&self, walk: impl Fn(&Self, &[usize], &Directions) -> Duration + Sync) -> f64 {
        let spent: Duration = self
            .receivers
            .iter()
            .enumerate()
            .map(|(l, receivers)| {
                let directions = Directions::new(self.operator.rays_on(l));
                receivers
                    .par_chunks(self.operator.chunk_on(l))
                    .map(|chunk| walk(self, chunk, &directions))
                    .sum::<Duration>()
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

    /// [`Self::walk_for`] in the casting order of a bake, in packets.
    fn walk_together_for(&self, chunk: &[usize], directions: &Directions) -> Duration {
        let mut rays = GatherRays::default();
        let (mut order, mut found) = (Vec::new(), Vec::new());
        let mut spent = Duration::ZERO;
        for group in chunk.chunks(receivers_together(directions)) {
            rays.clear();
            for &i in group {
                let epsilon = self.surfaces.epsilon();
                gather_rays(&self.points.points[i], i, self.operator.seed, epsilon, directions, &mut rays);
            }
            sort(&rays.cells, &mut order);
            // A bake also casts rays individually when primitives exceed the numbering.
            let primitives = self.surfaces.primitives();
            let began = Instant::now();
            for some in order.chunks(BATCH) {
                match primitives {
                    Some(primitives) => primitives.intersect_packet(&rays.rays, some, &mut found),
                    None => some.iter().map(|&i| &rays.rays[i as usize]).for_each(|(ray, seed)| {
                        black_box(self.surfaces.distance(ray, *seed));
                    }),
                }
                black_box(&found);
            }
            spent += began.elapsed();
        }
        spent
    }
}

/// Recorded ray queries, by thread, in their original order.
struct Asked(Vec<Vec<Question>>);

/// A recorded ray query.
enum Question {
    /// Nearest hit of a ray; with the ray's seed.
    Nearest(Ray, u32),
    /// Transmittance between two positions.
    Between(Vec3, Vec3),
}

impl Asked {
    fn count(&self) -> u64 {
        self.0.iter().map(|questions| questions.len() as u64).sum()
    }

    /// Traversal time in seconds on the threads of this pool.
    fn walk(&self, surfaces: &TriangleSurfaces) -> f64 {
        let walk = |questions: &[Question]| {
            let began = Instant::now();
            for question in questions {
                match question {
                    Question::Nearest(ray, seed) => drop(black_box(surfaces.distance(ray, *seed))),
                    Question::Between(from, to) => drop(black_box(surfaces.transmittance(*from, *to))),
                }
            }
            began.elapsed()
        };
        let chunks = self.0.par_iter().flat_map(|questions| questions.par_chunks(1 << 12));
        let spent: Duration = chunks.map(walk).sum();
        spent.as_secs_f64() / rayon::current_num_threads() as f64
    }
}

/// Surfaces that record ray queries.
struct Recorder<'a> {
    surfaces: &'a TriangleSurfaces,
    by_thread: Vec<Mutex<Vec<Question>>>,
}

impl<'a> Recorder<'a> {
    /// Creates a recorder for the threads of this pool.
    fn new(surfaces: &'a TriangleSurfaces) -> Self {
        let threads = 0..=rayon::current_num_threads();
        Self { surfaces, by_thread: threads.map(|_| Mutex::default()).collect() }
    }

    fn asked(self) -> Asked {
        Asked(self.by_thread.into_iter().filter_map(|questions| questions.into_inner().ok()).collect())
    }

    fn remember(&self, question: Question) {
        // The last list is for threads outside the pool.
        let list = rayon::current_thread_index().unwrap_or(self.by_thread.len() - 1);
        if let Ok(mut questions) = self.by_thread[list].lock() {
            questions.push(question);
        }
    }
}

impl Surfaces for Recorder<'_> {
    fn cast(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        self.remember(Question::Nearest(*ray, seed));
        self.surfaces.cast(ray, seed)
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        self.surfaces.see(ray, seed)
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        self.remember(Question::Between(from, to));
        self.surfaces.transmittance(from, to)
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        self.surfaces.bounds()
    }

    fn epsilon(&self) -> f32 {
        self.surfaces.epsilon()
    }
}
