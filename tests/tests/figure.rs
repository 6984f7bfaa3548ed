//! The walking figure: what a pose makes of it.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use glam::Vec3;
use rebounce::io::files::Memory;
use rebounce::io::{LoadOptions, PoseOption, load_from};
use rebounce::scene::Scene;
use rebounce_tests::figure::{SPEED, glb};

/// The figure at a time; at rest without.
fn figure(time: Option<f64>) -> Scene {
    let files = Memory::from_iter([("figure.glb", glb())]);
    let pose = time.map(|time| PoseOption { animation: Some("walk".into()), time });
    let options = LoadOptions { pose, ..LoadOptions::default() };
    load_from(&files, "figure.glb".as_ref(), &options).unwrap()
}

/// World-space corners of all triangles.
fn corners(scene: &Scene) -> Vec<Vec3> {
    let world = |i: &u32| scene.positions[*i as usize] + Vec3::from(scene.origin.map(|x| x as f32));
    scene.triangles.iter().flatten().map(world).collect()
}

#[test]
fn a_cycle_later_the_figure_stands_alike_farther_on() {
    let [first, later, between] = [0.35, 1.55, 0.95].map(|time| corners(&figure(Some(time))));
    let way = Vec3::Z * (SPEED * 1.2) as f32;
    let off = |a: &[Vec3], b: &[Vec3], by: Vec3| {
        a.iter().zip(b).map(|(a, b)| (*a + by).distance(*b)).fold(0.0f32, f32::max)
    };
    assert_eq!(first.len(), later.len());
    assert!(off(&first, &later, way) < 1e-3);
    // Half a cycle later it stands on the other leg.
    assert!(off(&first, &between, 0.5 * way) > 0.1);
}

#[test]
fn the_figure_walks_on_the_floor_and_keeps_its_size() {
    let rest = figure(None);
    let area = |scene: &Scene| {
        let triangle = |[a, b, c]: &[Vec3; 3]| 0.5 * (*b - *a).cross(*c - *a).length();
        corners(scene).as_chunks::<3>().0.iter().map(triangle).sum::<f32>()
    };
    let whole = area(&rest);
    // Limbs overlap at the joints.
    assert!((1.8..3.0).contains(&whole), "{whole} m²");
    for key in 0..12 {
        let time = 0.3 * f64::from(key);
        let posed = figure(Some(time));
        let corners = corners(&posed);
        let low = corners.iter().copied().fold(Vec3::INFINITY, Vec3::min);
        let high = corners.iter().copied().fold(Vec3::NEG_INFINITY, Vec3::max);
        assert!((-0.04..0.12).contains(&low.y) && (1.6..1.85).contains(&high.y), "{time} s: {low} to {high}");
        assert!((0.5 * (low.z + high.z) - (SPEED * time) as f32).abs() < 0.3, "{time} s: {low} to {high}");
        assert!((area(&posed) / whole - 1.0).abs() < 0.05, "{time} s");
    }
}
