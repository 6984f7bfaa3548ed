//! The walking figure: what a pose makes of it.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;

use glam::Vec3;
use rebounce::bake::bake;
use rebounce::demo::walker::SPEED;
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::picture::Only;
use rebounce::io::{LoadOptions, PoseOption, load_with};
use rebounce::scene::Scene;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::Relit;
use rebounce::verify::render::posed::PosedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::motion::Motions;
use rebounce_shared::rig::pose::Pose;
use rebounce_tests::small::settings;
use rebounce_viewer::settings::SolverChoice;
use std::sync::Arc;

const SIZE: [u32; 2] = [48, 36];

/// The figure at a time; at rest without.
fn figure(time: Option<f64>) -> Scene {
    let pose = time.map(|time| PoseOption { animation: Some("walk".into()), time });
    let options = LoadOptions { pose, ..LoadOptions::default() };
    load_with("builtin:walker", &options).unwrap()
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

#[test]
fn the_viewers_picture_of_a_pose_is_the_cpus() {
    let mut room = figure(None);
    let lamp =
        Light::Point { position: [1.2, 2.2, 1.5], intensity: 60.0, color: [1.0, 0.9, 0.8], radius: 0.0 };
    room.lights = vec![lamp.clone()];
    let file = bake(&room, &settings(1500), &()).unwrap().0;
    assert!(!file.rig.points.is_empty() && file.rig.layout.animations.len() == 1, "the figure is a rig");
    let Some(mut renderer) = common::renderer(&file) else { return };
    let time = 0.35f32;
    let (position, target) = ([1.6, 1.4, 2.6], [0.0, 0.9, 0.4]);
    let camera = Camera { position, target, up: [0.0, 1.0, 0.0], yfov_deg: 50.0 };
    renderer.set_camera(camera.clone()).unwrap();
    renderer.set_lights(vec![lamp.clone()]).unwrap();
    renderer.set_detail(false);
    // The CPU has the room's light of the figure at rest, as the operator has.
    renderer.set_solver(SolverChoice::Operator);
    let animation = &file.rig.layout.animations[0];
    let mut off = [None, Some(time)].map(|time| {
        renderer.pose(time.map(|_| 0), time.unwrap_or_default().into()).unwrap();
        let ours = [common::indirect(&mut renderer, SIZE), common::radiance(&mut renderer, SIZE)];
        let pose = time.map_or_else(|| Pose::rest(&file.rig), |time| Pose::of(&file.rig, animation, time));
        let posed = Arc::new(PosedScene::new(&file, &pose));
        let surfaces = TriangleSurfaces::from_baked(&posed.scene).unwrap();
        let pictures = [Only::Indirect, Only::All].map(|only| {
            let lighting = Lighting::new(std::slice::from_ref(&lamp), None, file.meta.origin, 0);
            let relit = Relit::posed(&file, &surfaces, lighting, false, (&Motions::default(), posed.clone()));
            let exposure = Exposure { size: SIZE, samples: 256, seed: 3 };
            relit.picture(&file, &surfaces, &camera, exposure, only, || ()).pixels
        });
        let off = [0, 1].map(|k| common::difference(&ours[k], &pictures[k]).0);
        println!("at {time:?}: bounced light {}, all {}", off[0], off[1]);
        (off, ours)
    });
    // Shadow maps and rays see limbs of some centimetres differently; a pose adds nothing to that.
    let ([rest, posed], [at_rest, moved]) = (off.each_mut().map(|(off, _)| *off), off.map(|(_, ours)| ours));
    for (name, k, most) in [("bounced light", 0, 0.06), ("all", 1, 0.06)] {
        assert!(
            posed[k] < most && posed[k] < rest[k] + 0.02,
            "{name}: {} at rest, {} posed",
            rest[k],
            posed[k]
        );
    }
    let (change, _) = common::difference(&moved[1], &at_rest[1]);
    assert!(change > 0.3, "the pose changes {change} only");
    renderer.gpu().check().unwrap();
}
