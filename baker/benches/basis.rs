//! Functions that cover a position: the hash grid against an R-tree (paper, section 2.1).
//!
//! `cargo bench -p rebounce-benches --bench basis` prints nanoseconds per query and the ratio, for every
//! level of points in a room, in alternating rounds.

#[path = "../tests/box_room/mod.rs"]
mod box_room;

use box_room::BoxRoom;
use glam::Vec3;
use rebounce::basis::{Evaluator, Support};
use rebounce::random::Stream;
use rebounce::sampling::emitter::ParticleEmitter;
use rebounce::sampling::{PlaceSettings, SurfacePoint, place};
use rebounce_shared::kernel::weight;
use rstar::{AABB, RTree, RTreeObject};
use std::time::Instant;

/// A function's support in the R-tree: the bounding box of a flat ellipsoid.
struct Boxed {
    position: Vec3,
    normal: Vec3,
    radius: f32,
}

impl RTreeObject for Boxed {
    type Envelope = AABB<[f32; 3]>;

    fn envelope(&self) -> Self::Envelope {
        let n2 = self.normal * self.normal;
        let half = self.radius * (Vec3::ONE - n2 * (8.0 / 9.0)).map(f32::sqrt);
        AABB::from_corners((self.position - half).to_array(), (self.position + half).to_array())
    }
}

fn main() {
    let room =
        BoxRoom { low: Vec3::new(-2.0, -1.0, -1.5), high: Vec3::new(2.0, 1.0, 1.5), albedo: Vec3::ONE };
    let settings = PlaceSettings { levels: 6, functions: 40_000, ..PlaceSettings::default() };
    let Ok(points) = place(&room, &ParticleEmitter::within(Vec3::ZERO), &settings, &()) else { return };
    let finest = &points.points[points.levels[5].range()];
    println!("level functions   found/query   grid ns   R-tree ns   R-tree over grid");
    for (l, level) in points.levels.iter().enumerate() {
        let list = &points.points[level.range()];
        let radius = level.support_radius;
        let grid = Evaluator::new(
            list.iter().map(|p| Support {
                position: p.position,
                normal: p.normal,
                radius,
                cuts: &[],
                group: 0,
            }),
            0,
        );
        let tree = RTree::bulk_load(
            list.iter().map(|p| Boxed { position: p.position, normal: p.normal, radius }).collect(),
        );
        let mut stream = Stream::new(5, l as u64);
        let queries: Vec<SurfacePoint> =
            (0..200_000).map(|_| finest[stream.bits() as usize % finest.len()]).collect();
        let (mut grid_ns, mut tree_ns) = (f64::INFINITY, f64::INFINITY);
        let (mut grid_sum, mut tree_sum, mut found) = (0.0, 0.0, 0usize);
        for _ in 0..5 {
            let start = Instant::now();
            grid_sum = 0.0;
            for q in &queries {
                grid_sum += grid.gather(q.position, q.normal, 0, |_, _| {}) as f64;
            }
            grid_ns = grid_ns.min(start.elapsed().as_nanos() as f64 / queries.len() as f64);
            let start = Instant::now();
            (tree_sum, found) = (0.0, 0);
            for q in &queries {
                for f in tree.locate_in_envelope_intersecting(&AABB::from_point(q.position.to_array())) {
                    let w = weight(q.position - f.position, q.normal, f.normal, f.radius);
                    tree_sum += w as f64;
                    found += (w > 0.0) as usize;
                }
            }
            tree_ns = tree_ns.min(start.elapsed().as_nanos() as f64 / queries.len() as f64);
        }
        assert!((grid_sum / tree_sum - 1.0f64).abs() < 1e-4, "both find the same functions");
        println!(
            "{l:5} {:9}   {:11.1}   {grid_ns:7.0}   {tree_ns:9.0}   {:16.2}",
            list.len(),
            found as f64 / queries.len() as f64,
            tree_ns / grid_ns
        );
    }
}
