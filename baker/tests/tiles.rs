//! The hit cache of tiles gives the same light as the evaluation of every hit.

use glam::Vec3;
use rebounce::basis::relate;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::geometry::{Hit, Ray, Surfaces};
use rebounce::sampling::emitter::ParticleEmitter;
use rebounce::sampling::{PlaceSettings, Points, cut, place};
use rebounce::scene::Scene;
use rebounce::transport::direct_to_indirect::{OperatorSettings, Refinement, tint};
use rebounce::transport::direct_to_indirect::{refine::refine, senders::Senders};
use rebounce_shared::interpolation::mean;
use rebounce_shared::link::Sent;
use split::split;

use crate::common::split;

/// Surfaces without `Primitives`.
struct HitByHit<'a>(&'a TriangleSurfaces);

impl Surfaces for HitByHit<'_> {
    fn cast(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        self.0.cast(ray, seed)
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        self.0.see(ray, seed)
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        self.0.transmittance(from, to)
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        self.0.bounds()
    }

    fn epsilon(&self) -> f32 {
        self.0.epsilon()
    }
}

/// One bounce over four levels, without margins for noise.
pub fn settings(seed: u64) -> OperatorSettings {
    OperatorSettings {
        refinement: Refinement::Gather,
        sender_levels: 4,
        epsilon: 1e-4,
        reflected: 1.0,
        rays: vec![2048, 1024, 512, 512],
        significance: 0.0,
        pooled_levels: 0,
        bounces: Some(1),
        later_levels: 2,
        far_levels: 0,
        levels: 4,
        seed,
    }
}

/// Irradiance at the points from senders of varying brightness.
fn received<S: Surfaces>(surfaces: &S, points: &Points, seed: u64) -> Vec<f32> {
    let settings = settings(seed);
    let relations = relate(points, 4).unwrap();
    let operator = refine(surfaces, points, &relations, &settings);
    assert!(operator.lost_share < 0.01, "{}", operator.lost_share);
    // From 0 to 2, within the length of a room.
    let sent = |i: usize| 1.0 + (2.0 * points.points[i].position.element_sum()).sin();
    let mut received: Vec<f32> = Vec::new();
    for (i, links) in operator.links.iter().enumerate() {
        let parents = mean(relations.push().row(i), 0.0, |parent| received[parent]).unwrap_or(0.0);
        received.push(parents + links.iter().map(|link| link.amount() * sent(link.sender())).sum::<f32>());
    }
    received
}

/// Relative RMS difference, and relative difference of the means.
fn compared(ours: &[f32], theirs: &[f32]) -> (f64, f64) {
    let (mut difference, mut square, mut sum, mut squares) = (0.0, 0.0, 0.0, 0.0);
    for (ours, theirs) in ours.iter().zip(theirs) {
        let (ours, theirs) = (*ours as f64, *theirs as f64);
        difference += ours - theirs;
        square += (ours - theirs).powi(2);
        sum += theirs;
        squares += theirs.powi(2);
    }
    ((square / squares).sqrt(), difference / sum)
}

/// Every triangle cut into n x n.
fn cut_up(scene: &Scene, n: u32) -> TriangleSurfaces {
    let mut scene = scene.clone();
    split(&mut scene, n);
    TriangleSurfaces::from_scene(&scene)
}

/// Points on a scene's surfaces, and the surfaces.
fn placed(name: &str) -> (Scene, TriangleSurfaces, Points) {
    let scene = rebounce::io::load(name).unwrap();
    let surfaces = TriangleSurfaces::from_scene(&scene);
    let settings = PlaceSettings { levels: 4, functions: 3_000, ..PlaceSettings::default() };
    let (low, high) = surfaces.bounds();
    let mut points = place(&surfaces, &ParticleEmitter::within(low.lerp(high, 0.4)), &settings, &()).unwrap();
    let count = points.points.len();
    cut(&surfaces, &mut points, count, &()).unwrap();
    (scene, surfaces, points)
}

/// Asserts that tiles change the result less than a change of the random rays.
fn assert_close(name: &str, surfaces: &TriangleSurfaces, points: &Points) {
    let by_tiles = received(surfaces, points, 5);
    let by_hits = received(&HitByHit(surfaces), points, 5);
    let by_other_rays = received(&HitByHit(surfaces), points, 6);
    let (error, bias) = compared(&by_tiles, &by_hits);
    let (noise, _) = compared(&by_other_rays, &by_hits);
    println!("{name}: error {error:.4}, bias {bias:.4}; other rays {noise:.4}");
    assert!(error < noise && bias.abs() < 0.004, "{name}: error {error} of {noise}, bias {bias}");
    assert_ne!(by_tiles, by_hits, "{name}: tiles are read");
}

#[test]
fn tiles_change_less_than_other_rays_do_and_take_no_light() {
    for name in ["builtin:two-rooms-door", "builtin:library"] {
        let (_, surfaces, points) = placed(name);
        assert_close(name, &surfaces, &points);
    }
}

#[test]
fn small_triangles_share_tiles() {
    let (scene, whole, points) = placed("builtin:two-rooms-door");
    let tiles = |surfaces: &TriangleSurfaces| {
        let tints = tint::tints(surfaces, &points, 5);
        let settings = settings(5);
        let senders = Senders::unwatched(surfaces, &points, &settings, &tints);
        let relations = relate(&points, 4).unwrap();
        senders.context(surfaces, &points, &relations, &settings).tiles.unwrap().count()
    };
    let many = cut_up(&scene, 64);
    assert!(many.triangle_count() == whole.triangle_count() * 4096);
    let [few, many_tiles] = [&whole, &many].map(tiles);
    println!("{} triangles, {few} tiles; {}, {many_tiles}", whole.triangle_count(), many.triangle_count());
    // A wall of few triangles is partly out of reach of the finest functions, and has wide tiles there.
    assert!(many_tiles < 10 * few && 2 * many_tiles < many.triangle_count(), "{many_tiles}, not {few}");
    assert_close("cut up", &many, &points);
}
