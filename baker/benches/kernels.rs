//! The most expensive kernels of a bake, measured individually on one thread, in a furnished room.
//!
//! * `cargo bench -p rebounce-benches --bench kernels [-- FILTER]`: time, by criterion;
//! * `cargo xtask bench-kernels`: instructions, independent of the load of the machine. The command
//!   runs this benchmark with `--count` under valgrind, which counts instructions within
//!   [`counted`] by the kernel's function, named like the kernel.

use anyhow::Result;
use criterion::{Criterion, Throughput};
use rebounce::bake::{BakeSettings, Preset, choose_emitter};
use rebounce::basis::{Relations, relate};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Hit, Primitives, Ray, Surfaces};
use rebounce::sampling::emitter::ParticleEmitter;
use rebounce::sampling::{PlaceSettings, Points, place};
use rebounce::transport::direct_to_indirect::bounces::{add_later_bounces, column_count};
use rebounce::transport::direct_to_indirect::directions::Directions;
use rebounce::transport::direct_to_indirect::gather::{Gather, Gathered, Scratch};
use rebounce::transport::direct_to_indirect::gather_batch::BATCH;
use rebounce::transport::direct_to_indirect::gather_context::GatherContext;
use rebounce::transport::direct_to_indirect::hemisphere::{GatherRays, gather_rays};
use rebounce::transport::direct_to_indirect::hit_cache::{HitCache, Layout};
use rebounce::transport::direct_to_indirect::ray_sort::sort;
use rebounce::transport::direct_to_indirect::{Operator, OperatorSettings, tint};
use rebounce::transport::direct_to_indirect::{refine::Refiner, senders::Senders};
use rebounce_shared::link::Link;
use rebounce_shared::rbn::LinkMatrix;
use rebounce_shared::rbn::codec::links::{decode, encode};
use std::hint::black_box;

const SCENE: &str = "builtin:library";
/// Functions on the finest level, and number of levels. Small, because the setup is repeated under
/// valgrind.
const POINTS: (usize, usize) = (8_000, 4);
/// Number of levels of later bounces.
const LATER: usize = 2;
/// Receivers per measured gather, distributed over the room.
const RECEIVERS: usize = 64;
/// Rays per receiver.
const RAYS: u32 = 512;
/// Neighbouring receivers per gather batch, and number of gather batches.
const NEIGHBOURS: usize = 8;
const PLACES: usize = 16;

/// Input of the kernels.
struct Room {
    surfaces: TriangleSurfaces,
    emitter: ParticleEmitter,
    place: PlaceSettings,
    operator: OperatorSettings,
    points: Points,
    relations: Relations,
    senders: Senders,
    directions: Directions,
    /// Rays of gathers distributed over the room. Their hits are in `hits`.
    rays: Vec<(Ray, u32)>,
    /// Rays of neighbouring receivers, for packets.
    near: Vec<(Ray, u32)>,
    /// Casting order of `near`.
    order: Vec<u32>,
    hits: Vec<Hit>,
    /// Operator without later bounces.
    baked: Operator,
    /// Values of the coarse receivers, which finer receivers subtract.
    values: Vec<Vec<Link>>,
    links: LinkMatrix<Link>,
    packed: Vec<u8>,
}

impl Room {
    fn new() -> Result<Self> {
        let scene = rebounce::io::load(SCENE)?;
        let mut settings = BakeSettings::new(Preset::Draft);
        (settings.place.functions, settings.place.levels) = POINTS;
        settings.operator.rays = vec![RAYS];
        settings.operator.later_levels = LATER;
        let settings = settings.normalised();
        let operator = settings.operator.clone();
        let surfaces = TriangleSurfaces::from_scene(&scene);
        let emitter = choose_emitter(&scene, &surfaces, &settings)?;
        let points = place(&surfaces, &emitter, &settings.place, &())?;
        let relations = relate(&points, settings.direct_levels)?;
        let tints = tint::tints(&surfaces, &points, operator.seed);
        let senders = Senders::unwatched(&surfaces, &points, &operator, &tints);
        let baked = {
            let mut refiner = Refiner::new(&surfaces, &points, &relations, &operator, &senders, tints);
            for _ in 0..operator.later_levels {
                refiner.level();
            }
            let rows = refiner.coarse_matrix().rows();
            refiner.set_coarse(rows);
            refiner.finish()
        };
        let links = LinkMatrix::from_rows(&baked.links);
        let mut room = Self {
            senders,
            packed: encode(&links.offsets, &links.links),
            values: vec![Vec::new(); points.points.len()],
            directions: Directions::new(RAYS),
            place: settings.place,
            rays: Vec::new(),
            near: Vec::new(),
            order: Vec::new(),
            hits: Vec::new(),
            surfaces,
            emitter,
            operator,
            points,
            relations,
            baked,
            links,
        };
        room.look_around();
        Ok(room)
    }

    /// Casts rays, and gathers the values that the finest receivers subtract.
    fn look_around(&mut self) {
        let mut rays = GatherRays::default();
        for i in self.receivers(self.finest()) {
            let epsilon = self.surfaces.epsilon();
            gather_rays(&self.points.points[i], i, 1, epsilon, &self.directions, &mut rays);
        }
        self.rays = rays.rays;
        self.hits = self.rays.iter().filter_map(|(ray, seed)| self.surfaces.cast(ray, *seed)).collect();
        let mut order = Vec::new();
        let finest = self.points.levels[self.finest()].range();
        for first in finest.clone().step_by(finest.len() / PLACES + 1) {
            let mut rays = GatherRays::default();
            for i in (first..finest.end).take(NEIGHBOURS) {
                let epsilon = self.surfaces.epsilon();
                gather_rays(&self.points.points[i], i, 1, epsilon, &self.directions, &mut rays);
            }
            sort(&rays.cells, &mut order);
            self.order.extend(order.iter().map(|number| self.near.len() as u32 + number));
            self.near.extend(rays.rays);
        }
        let mut parents: Vec<usize> = self
            .receivers(self.finest())
            .flat_map(|i| self.relations.push().row(i).iter().map(|parent| parent.point()))
            .collect();
        parents.sort_unstable();
        parents.dedup();
        let mut scratch = self.scratch();
        let found = self.gather(&parents, self.finest() - 1, &mut scratch);
        parents.into_iter().zip(found).for_each(|(i, gathered)| self.values[i] = gathered.value);
    }

    fn finest(&self) -> usize {
        self.points.levels.len() - 1
    }

    /// Up to [`RECEIVERS`] receivers of a level, evenly along the space-filling curve.
    fn receivers(&self, level: usize) -> impl Iterator<Item = usize> + use<> {
        let range = self.points.levels[level].range();
        let step = range.len().div_ceil(RECEIVERS).max(1);
        range.step_by(step)
    }

    fn context(&self) -> GatherContext<'_, TriangleSurfaces> {
        self.senders.context(&self.surfaces, &self.points, &self.relations, &self.operator)
    }

    fn scratch(&self) -> Scratch {
        Scratch::new(self.points.points.len())
    }

    fn gather(&self, receivers: &[usize], level: usize, scratch: &mut Scratch) -> Vec<Gathered> {
        let mut all = Vec::with_capacity(receivers.len());
        let (directions, values) = (&self.directions, &self.values[..]);
        let gather = Gather { receivers, level, directions, values };
        self.context().links(&gather, scratch, |_, gathered| all.push(gathered));
        all
    }

    /// Gathers for receivers of a level and returns the number of rays.
    fn gather_on(&self, level: usize) -> u64 {
        let mut scratch = self.scratch();
        let receivers: Vec<usize> = self.receivers(level).collect();
        black_box(self.gather(&receivers, level, &mut scratch))
            .iter()
            .map(|gathered| gathered.cost.rays)
            .sum()
    }
}

/// A kernel: name of the function, unit of work, and the function, which returns the number of
/// units done.
struct Kernel {
    name: &'static str,
    unit: &'static str,
    run: fn(&Room) -> u64,
}

const KERNELS: [Kernel; 11] = [
    Kernel { name: "walk", unit: "ray, to the nearest hit", run: walk },
    Kernel { name: "walk_together", unit: "ray, with those that go alike", run: walk_together },
    Kernel { name: "cast", unit: "ray, its hit shaded", run: cast },
    Kernel { name: "cover", unit: "hit, the functions that cover it", run: cover },
    Kernel { name: "lay_tiles", unit: "tile", run: lay_tiles },
    Kernel { name: "gather_fine", unit: "ray of a finest receiver", run: gather_fine },
    Kernel { name: "gather_coarse", unit: "ray of a coarsest receiver", run: gather_coarse },
    Kernel { name: "bounces", unit: "column and entry of the coarse rows", run: bounces },
    Kernel { name: "encode_links", unit: "link", run: encode_links },
    Kernel { name: "decode_links", unit: "link", run: decode_links },
    Kernel { name: "place_points", unit: "point", run: place_points },
];

#[inline(never)]
fn walk(room: &Room) -> u64 {
    for (ray, seed) in &room.rays {
        black_box(room.surfaces.distance(ray, *seed));
    }
    room.rays.len() as u64
}

#[inline(never)]
fn walk_together(room: &Room) -> u64 {
    let mut found = Vec::new();
    for some in room.order.chunks(BATCH) {
        room.surfaces.intersect_packet(&room.near, some, &mut found);
        black_box(&found);
    }
    room.order.len() as u64
}

#[inline(never)]
fn cast(room: &Room) -> u64 {
    for (ray, seed) in &room.rays {
        black_box(room.surfaces.cast(ray, *seed));
    }
    room.rays.len() as u64
}

#[inline(never)]
fn cover(room: &Room) -> u64 {
    let senders = room.context().senders;
    let mut weights = Vec::new();
    for hit in &room.hits {
        senders.interpolate(hit.position, hit.normal, hit.group, &mut weights);
        black_box(&weights);
    }
    room.hits.len() as u64
}

#[inline(never)]
fn lay_tiles(room: &Room) -> u64 {
    let GatherContext { surfaces, senders, duals, settings, .. } = room.context();
    let tiles = Layout::new(surfaces, senders, duals.len(), &())
        .and_then(|layout| HitCache::on(layout, surfaces, senders, duals, settings.seed, &()));
    black_box(tiles).map_or(0, |tiles| tiles.count() as u64)
}

#[inline(never)]
fn gather_fine(room: &Room) -> u64 {
    room.gather_on(room.finest())
}

#[inline(never)]
fn gather_coarse(room: &Room) -> u64 {
    room.gather_on(0)
}

#[inline(never)]
fn bounces(room: &Room) -> u64 {
    let mut operator = Operator {
        coarse: room.baked.coarse.clone(),
        tints: room.baked.tints.clone(),
        ..Operator::default()
    };
    let entries: usize = operator.coarse_count();
    add_later_bounces(&mut operator, &room.operator);
    assert!(operator.later_count() > 0, "no later bounces");
    column_count(&room.baked, &room.operator) as u64 * entries as u64
}

#[inline(never)]
fn encode_links(room: &Room) -> u64 {
    black_box(encode(&room.links.offsets, &room.links.links));
    room.links.links.len() as u64
}

#[inline(never)]
fn decode_links(room: &Room) -> u64 {
    let unpacked = decode::<Link>(&room.packed).map(|(_, links)| links.len());
    assert_eq!(unpacked.ok(), Some(room.links.links.len()), "what was packed is unpacked");
    room.links.links.len() as u64
}

#[inline(never)]
fn place_points(room: &Room) -> u64 {
    let points = place(&room.surfaces, &room.emitter, &room.place, &());
    points.map_or(0, |points| points.points.len() as u64)
}

/// The scope of valgrind's count.
#[inline(never)]
fn counted(kernel: &Kernel, room: &Room) -> u64 {
    black_box((kernel.run)(room))
}

fn main() -> Result<()> {
    // All work runs on this thread, the only measured thread.
    rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread().build_global()?;
    let room = Room::new()?;
    if std::env::args().any(|arg| arg == "--count") {
        for kernel in &KERNELS {
            println!("counted {} {} {}", kernel.name, counted(kernel, &room), kernel.unit);
        }
        return Ok(());
    }
    let mut criterion = Criterion::default().sample_size(20).configure_from_args();
    for kernel in &KERNELS {
        let mut group = criterion.benchmark_group(kernel.name);
        group.throughput(Throughput::Elements(counted(kernel, &room)));
        group.bench_function(kernel.unit, |bencher| bencher.iter(|| counted(kernel, &room)));
        group.finish();
    }
    criterion.final_summary();
    Ok(())
}
