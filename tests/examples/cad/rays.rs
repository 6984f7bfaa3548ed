//! Rays against exact faces and against their tessellations: lost hits, and speed.

use anyhow::Result;
use glam::Vec3;
use rayon::prelude::*;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Hit, Ray, SceneSurfaces, Surfaces};
use rebounce::random::Stream;
use rebounce::scene::Scene;
use std::hint::black_box;
use std::time::Instant;

/// Rays of a timing, and rounds; the best round counts.
const TIMED: u64 = 200_000;
const ROUNDS: usize = 3;
/// Sideways steps of a ray that tell a hit from a touch, in chord errors.
const ASIDE: f32 = 4.0;

/// What rays found.
#[derive(Clone, Copy, Default)]
struct Found {
    rays: u64,
    hits: u64,
    /// Rays that the faces let pass where the triangles go on around the ray.
    lost: u64,
    /// The reverse: cracks between the tessellations of faces.
    lost_by_triangles: u64,
    /// Rays that differ where either surface ends or turns away.
    touching: u64,
}

impl Found {
    fn plus(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            hits: self.hits + other.hits,
            lost: self.lost + other.lost,
            lost_by_triangles: self.lost_by_triangles + other.lost_by_triangles,
            touching: self.touching + other.touching,
        }
    }
}

/// Prints a row for each scene: `rays` random rays against exact faces and triangles whose chord error is a share `of_diagonal`.
pub fn lost_hits(scenes: &[(String, Scene)], rays: u64, of_diagonal: f32) -> Result<()> {
    println!("| scene | faces | triangles | rays | hits | lost | lost by triangles | at rims |");
    println!("|---|---|---|---|---|---|---|---|");
    for (name, scene) in scenes {
        let exact = SceneSurfaces::from_scene(scene);
        let triangles = TriangleSurfaces::from_scene(scene);
        let (low, high) = scene.bounds();
        let chord = of_diagonal * (high - low).length();
        let ray = |i: u64| {
            let mut stream = Stream::new(71, i);
            let within = Vec3::new(stream.unit(), stream.unit(), stream.unit());
            let from = Vec3::new(stream.unit(), stream.unit(), stream.unit());
            // Between points of a box somewhat larger than the scene.
            let place = |at: Vec3| low + (high - low) * (1.4 * at - 0.2);
            Ray::visibility(place(from), (place(within) - place(from)).normalize_or(Vec3::Y))
        };
        let one = |i: u64| compared(&exact, &triangles, &ray(i), chord);
        let found = (0..rays).into_par_iter().map(one).reduce(Found::default, Found::plus);
        let faces = scene.brep.as_ref().map_or(0, |brep| brep.faces.len());
        let Found { rays, hits, lost, lost_by_triangles, touching } = found;
        println!(
            "| {name} | {faces} | {} | {rays} | {hits} | {lost} | {lost_by_triangles} | {touching} |",
            scene.triangles.len()
        );
    }
    Ok(())
}

/// Casts a ray to both.
fn compared(exact: &SceneSurfaces, triangles: &TriangleSurfaces, ray: &Ray, chord: f32) -> Found {
    let (a, b) = (exact.cast(ray, 0), triangles.cast(ray, 0));
    let mut found = Found { rays: 1, hits: u64::from(a.is_some()), ..Found::default() };
    // A ray may begin between a face and its triangles.
    let is_between = [&a, &b].into_iter().flatten().any(|hit| hit.distance < ASIDE * chord);
    if is_between || is_same(&a, &b, ray, chord) {
        return found;
    }
    // Beside the ray, the surface that it meets first goes on: the other one has lost it.
    let (x, y) = ray.direction.any_orthonormal_pair();
    let aside = ASIDE * chord;
    let goes_on = [x, -x, y, -y].into_iter().all(|step| {
        let beside = Ray { origin: ray.origin + aside * step, ..*ray };
        let [of_exact, of_triangles] = [exact.cast(&beside, 0), triangles.cast(&beside, 0)];
        let near = |hit: &Option<Hit>, other: &Option<Hit>| match (hit, other) {
            (Some(hit), Some(other)) => {
                // A step aside is as much along the ray as the surface is steep.
                let cosine = other.normal.dot(ray.direction).abs().max(0.02);
                (hit.distance - other.distance).abs() < 2.0 * ASIDE * chord / cosine
            }
            (None, None) => true,
            _ => false,
        };
        near(&of_exact, &a) && near(&of_triangles, &b)
    });
    if goes_on {
        let told = |hit: Option<Hit>| hit.map(|hit| (hit.distance, hit.position, hit.normal));
        eprintln!("lost: {ray:?}: faces {:?}, triangles {:?}", told(a), told(b));
        let distance = |hit: Option<Hit>| hit.map_or(f32::INFINITY, |hit| hit.distance);
        let is_of_faces = distance(a) > distance(b);
        found.lost = u64::from(is_of_faces);
        found.lost_by_triangles = u64::from(!is_of_faces);
    } else {
        found.touching = 1;
    }
    found
}

/// Whether hits are those of one surface.
fn is_same(a: &Option<Hit>, b: &Option<Hit>, ray: &Ray, chord: f32) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => {
            let cosine = a.normal.dot(ray.direction).abs().min(b.normal.dot(ray.direction).abs());
            (a.distance - b.distance).abs() <= 3.0 * chord / cosine.max(0.02)
        }
        (None, None) => true,
        _ => false,
    }
}

/// Prints a row for each scene: millions of rays a second of one thread, from surface to surface.
pub fn speed(scenes: &[(String, Scene)]) -> Result<()> {
    println!("| scene | faces | Mrays/s | triangles | Mrays/s | ratio |");
    println!("|---|---|---|---|---|---|");
    for (name, scene) in scenes {
        let exact = SceneSurfaces::from_scene(scene);
        let triangles = TriangleSurfaces::from_scene(scene);
        let rays = leaving(&exact);
        let mut best = [f64::INFINITY; 2];
        for _ in 0..ROUNDS {
            let all: [&dyn Surfaces; 2] = [&exact, &triangles];
            for (surfaces, best) in all.into_iter().zip(&mut best) {
                let began = Instant::now();
                for ray in &rays {
                    black_box(surfaces.cast(ray, 1));
                }
                *best = best.min(began.elapsed().as_secs_f64());
            }
        }
        let [a, b] = best.map(|seconds| rays.len() as f64 / seconds * 1e-6);
        let faces = scene.brep.as_ref().map_or(0, |brep| brep.faces.len());
        println!("| {name} | {faces} | {a:.2} | {} | {b:.2} | {:.2} |", scene.triangles.len(), a / b);
    }
    Ok(())
}

/// Rays that leave surfaces in cosine-distributed directions.
fn leaving(surfaces: &SceneSurfaces) -> Vec<Ray> {
    let (low, high) = surfaces.bounds();
    let leave = |i: u64| {
        let mut stream = Stream::new(1, i);
        let from = low + (high - low) * Vec3::new(stream.unit(), stream.unit(), stream.unit());
        let hit = surfaces.cast(&Ray::visibility(from, stream.sphere()), 0)?;
        let direction = stream.cosine_hemisphere(hit.geometric_normal);
        Some(Ray::visibility(hit.offset_origin(direction, surfaces.epsilon()), direction))
    };
    (0..TIMED).filter_map(leave).collect()
}
