//! Points, on a scene with dark corners.

use rebounce::geometry::Surfaces;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::sampling::emitter::ParticleEmitter;
use rebounce::sampling::{PlaceSettings, place};

#[test]
fn how_many_points_there_are_is_no_matter_of_luck() {
    let scene = rebounce::io::load("builtin:library").unwrap();
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let (low, high) = surfaces.bounds();
    let radius = Some(0.08 * (high - low).length());
    let counts: Vec<f64> = (1..=8)
        .map(|seed| {
            let settings =
                PlaceSettings { levels: 4, coarse_radius: radius, seed, ..PlaceSettings::default() };
            let points =
                place(&surfaces, &ParticleEmitter::within(low.lerp(high, 0.4)), &settings, &()).unwrap();
            points.levels[3].count as f64
        })
        .collect();
    let mean = counts.iter().sum::<f64>() / 8.0;
    let spread = (counts.iter().map(|count| (count - mean).powi(2)).sum::<f64>() / 7.0).sqrt() / mean;
    println!("{counts:?}: {spread}");
    assert!(mean > 3_000.0 && spread < 0.006, "{counts:?}: {spread}");
}
