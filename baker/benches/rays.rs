//! How fast rays are cast: `cargo bench -p rebounce --bench rays [-- SCENE]`, one thread,
//! millions of rays a second. The rays are those of a path tracer after its first bounce.

use glam::Vec3;
use rebounce::random::Stream;
use rebounce::scene;
use rebounce::surface::{Ray, Surfaces};
use rebounce::triangles::TriangleSurfaces;
use std::hint::black_box;
use std::time::Instant;

fn main() -> Result<(), scene::SceneError> {
    // Cargo passes --bench itself.
    let spec = std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or("builtin:cornell-box".into());
    let scene = scene::load(&spec)?;
    let began = Instant::now();
    let surfaces = TriangleSurfaces::from_scene(&scene);
    println!("{spec}: {} triangles, built in {:.2} s", scene.triangles.len(), began.elapsed().as_secs_f64());
    let rays = incoherent_rays(&surfaces, 300_000);
    let length = 0.1 * scene.bounds().1.length();
    for round in 0..3 {
        let began = Instant::now();
        let hits = rays.iter().filter(|ray| black_box(surfaces.cast(ray, 1)).is_some()).count();
        let cast = rays.len() as f64 / began.elapsed().as_secs_f64() * 1e-6;
        let began = Instant::now();
        let middle = |ray: &Ray| ray.origin + ray.direction * length;
        let open = rays.iter().filter(|ray| surfaces.transmittance(ray.origin, middle(ray)) > 0.0).count();
        let seen = rays.len() as f64 / began.elapsed().as_secs_f64() * 1e-6;
        println!("round {round}: cast {cast:.2}, transmittance {seen:.2} Mrays/s ({hits} hits, {open} open)");
    }
    Ok(())
}

/// Rays that leave surfaces seen from the middle of the scene, in cosine-distributed directions.
fn incoherent_rays(surfaces: &TriangleSurfaces, count: u64) -> Vec<Ray> {
    let leave = |i: u64| {
        let mut stream = Stream::new(1, i);
        let eye = Ray { origin: Vec3::ZERO, direction: stream.sphere(), max_distance: f32::INFINITY };
        let hit = surfaces.cast(&eye, 0)?;
        let direction = stream.cosine_hemisphere(hit.geometric_normal);
        Some(Ray { origin: hit.offset_origin(direction, surfaces.epsilon()), direction, ..eye })
    };
    (0..count).filter_map(leave).collect()
}
