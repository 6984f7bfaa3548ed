//! Ray throughput: `cargo bench -p rebounce-benches --bench rays [-- SCENE]`, one thread, millions of rays
//! a second. Measures rays of a path tracer after its first bounce, and gather rays of a bake,
//! individually and in packets.

use anyhow::{Context, Result, ensure};
use glam::Vec3;
use rebounce::bake::{BakeSettings, Preset, choose_emitter};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Ray, Surfaces};
use rebounce::random::Stream;
use rebounce::sampling::place;
use rebounce::scene;
use rebounce::transport::direct_to_indirect::directions::Directions;
use rebounce::transport::direct_to_indirect::gather::receivers_together;
use rebounce::transport::direct_to_indirect::gather_batch::BATCH;
use rebounce::transport::direct_to_indirect::hemisphere::{GatherRays, gather_rays};
use rebounce::transport::direct_to_indirect::ray_sort::sort;
use std::hint::black_box;
use std::time::Instant;

/// Rays per timing.
const FEW: usize = 512;
/// Number of rounds; the best round counts.
const ROUNDS: usize = 8;
/// Stride of the measured groups of receivers.
const EVERY: usize = 8;

/// Asks something along a ray.
type Query<'a> = &'a dyn Fn(&Ray) -> bool;

fn main() -> Result<()> {
    // Cargo passes --bench as an argument.
    let spec = std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or("builtin:cornell-box".into());
    let scene = rebounce::io::load(&spec)?;
    let began = Instant::now();
    let surfaces = TriangleSurfaces::from_scene(&scene);
    println!("{spec}: {} triangles, built in {:.2} s", scene.triangles.len(), began.elapsed().as_secs_f64());
    let rays = incoherent_rays(&surfaces, 300_000);
    let length = 0.1 * scene.bounds().1.length();
    let middle = |ray: &Ray| ray.origin + ray.direction * length;
    let walk = |ray: &Ray| surfaces.distance(ray, 1).is_some();
    let cast = |ray: &Ray| surfaces.cast(ray, 1).is_some();
    let open = |ray: &Ray| surfaces.transmittance(ray.origin, middle(ray)).max_element() > 0.0;
    let kinds: [(&str, Query); 3] = [("the walk alone", &walk), ("cast", &cast), ("transmittance", &open)];
    // Kinds alternate, and the best time of each group counts: other jobs make rays slower, never
    // faster.
    let mut best = vec![[f64::INFINITY; 3]; rays.len().div_ceil(FEW)];
    let mut true_for = [0; 3];
    for _ in 0..ROUNDS {
        true_for = [0; 3];
        for (rays, best) in rays.chunks(FEW).zip(&mut best) {
            for (((_, test), best), true_for) in kinds.iter().zip(best).zip(&mut true_for) {
                let began = Instant::now();
                *true_for += rays.iter().filter(|ray| black_box(test(ray))).count();
                *best = best.min(began.elapsed().as_secs_f64());
            }
        }
    }
    for (k, (name, _)) in kinds.iter().enumerate() {
        let speed = rays.len() as f64 / best.iter().map(|best| best[k]).sum::<f64>() * 1e-6;
        println!("{name}: {speed:.2} Mrays/s ({} of {} true)", true_for[k], rays.len());
    }
    gathers(&scene, &surfaces)
}

/// Rays that leave surfaces seen from the middle of the scene, in cosine-distributed directions.
fn incoherent_rays(surfaces: &TriangleSurfaces, count: u64) -> Vec<Ray> {
    let leave = |i: u64| {
        let mut stream = Stream::new(1, i);
        let eye =
            Ray { origin: Vec3::ZERO, direction: stream.sphere(), max_distance: f32::INFINITY, spread: 0.0 };
        let hit = surfaces.cast(&eye, 0)?;
        let direction = stream.cosine_hemisphere(hit.geometric_normal);
        Some(Ray { origin: hit.offset_origin(direction, surfaces.epsilon()), direction, ..eye })
    };
    (0..count).filter_map(leave).collect()
}

/// Casts the rays of finest receivers at `standard`, in the casting order of a bake.
fn gathers(scene: &scene::Scene, surfaces: &TriangleSurfaces) -> Result<()> {
    let settings = BakeSettings::new(Preset::Standard).normalised();
    let emitter = choose_emitter(scene, surfaces, &settings)?;
    let points = place(surfaces, &emitter, &settings.place, &())?;
    let finest: Vec<usize> = points.levels.last().map_or(Vec::new(), |level| level.range().collect());
    let primitives = surfaces.primitives().context("too many triangles")?;
    let directions = Directions::new(settings.operator.rays_on(points.levels.len() - 1));
    let mut gathered = GatherRays::default();
    let mut order = Vec::new();
    let (mut alone, mut together, mut some_together) = (Vec::new(), Vec::new(), Vec::new());
    let mut best = [f64::INFINITY; 2];
    let mut count = 0;
    for round in 0..ROUNDS {
        count = 0;
        let mut seconds = [0.0; 2];
        for some in finest.chunks(receivers_together(&directions)).step_by(EVERY) {
            gathered.clear();
            for &i in some {
                gather_rays(&points.points[i], i, 1, surfaces.epsilon(), &directions, &mut gathered);
            }
            let rays = &gathered.rays;
            sort(&gathered.cells, &mut order);
            count += order.len();
            // The second run finds nodes and triangles in cache; therefore the order alternates.
            for way in [round % 2, 1 - round % 2] {
                let began = Instant::now();
                if way == 0 {
                    alone.clear();
                    alone.extend(
                        order.iter().map(|&i| primitives.find(&rays[i as usize].0, rays[i as usize].1)),
                    );
                } else {
                    together.clear();
                    for numbers in order.chunks(BATCH) {
                        primitives.intersect_packet(rays, numbers, &mut some_together);
                        together.extend_from_slice(&some_together);
                    }
                }
                let spent = began.elapsed().as_secs_f64();
                // Only the first run counts.
                seconds[way] += if way == round % 2 { spent } else { 0.0 };
            }
            ensure!(alone == together, "rays find something else together");
        }
        let way = round % 2;
        best[way] = best[way].min(seconds[way]);
    }
    let speed = best.map(|seconds| count as f64 / seconds * 1e-6);
    println!("gathers, one by one: {:.2} Mrays/s, together: {:.2} ({count} rays)", speed[0], speed[1]);
    Ok(())
}
