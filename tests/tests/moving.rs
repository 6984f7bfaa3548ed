//! Nodes that move in the viewer: bounced light by radiosity on the GPU is the CPU's after a motion.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use crate::common;
use crate::crowd;

use crowd::{Said, glb};
use rebounce::bake::{BakeSolver, bake};
use rebounce::geometry::mesh::TriangleSurfaces;
use rebounce::io::LoadOptions;
use rebounce::io::files::Memory;
use rebounce::io::picture::Only;
use rebounce::verify::expose::Exposure;
use rebounce::verify::render::Relit;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use rebounce_shared::lighting::Lighting;
use rebounce_shared::motion::{Motions, NodeMotion};
use rebounce_tests::small::settings;

const SIZE: [u32; 2] = [96, 64];

/// A room with over a hundred balls, each of which may move.
fn crowd(light: Light) -> BakedScene {
    let files = Memory::from_iter([("crowd.glb", glb(Said::Nodes))]);
    let options = LoadOptions { all_nodes_move: true, ..LoadOptions::default() };
    let mut room = rebounce::io::load_from(&files, "crowd.glb".as_ref(), &options).unwrap();
    room.lights = vec![light];
    let mut settings = settings(3000);
    settings.solver = BakeSolver::Radiosity;
    settings.viewpoints = vec![[0.0, 3.5, 0.0]];
    bake(&room, &settings.normalised(), &()).unwrap().0
}

#[test]
fn light_of_moved_nodes_is_the_cpus() {
    let light =
        Light::Point { position: [1.0, 3.6, 0.5], intensity: 30.0, color: [1.0, 0.9, 0.8], radius: 0.0 };
    let scene = crowd(light.clone());
    assert!(scene.is_unlinked() && scene.groups.nodes.len() > 100);
    let Some(mut renderer) = common::renderer(&scene) else { return };
    let (position, target) = ([5.0, 3.0, 4.2], [-1.0, 1.0, -1.0]);
    let camera = Camera { position, target, up: [0.0, 1.0, 0.0], yfov_deg: 60.0 };
    renderer.set_camera(camera.clone()).unwrap();
    renderer.set_lights(vec![light.clone()]).unwrap();
    // The room stays, every third ball moves.
    let moved: Vec<NodeMotion> = (0..scene.groups.nodes.len())
        .map(|i| match i % 3 {
            1 => NodeMotion { translation: [0.4, 0.9, -0.3], rotation_y_deg: 70.0, ..NodeMotion::default() },
            _ => NodeMotion::default(),
        })
        .collect();
    let before = common::indirect(&mut renderer, SIZE);
    renderer.move_nodes(&moved).unwrap();
    let ours = common::indirect(&mut renderer, SIZE);
    assert!(!renderer.is_solving());
    let motions = Motions::new(&scene.groups, &moved, scene.meta.origin);
    let surfaces = TriangleSurfaces::from_moved(&scene, &motions).unwrap();
    let lighting = Lighting::new(&[light], None, scene.meta.origin, 0);
    let relit = Relit::moved(&scene, &surfaces, lighting, true, &motions);
    let exposure = Exposure { size: SIZE, samples: 256, seed: 3 };
    let truth = relit.picture(&scene, &surfaces, &camera, exposure, Only::Indirect, || ()).pixels;
    let (error, bias) = common::difference(&ours, &truth);
    let (change, _) = common::difference(&ours, &before);
    println!("error {error}, bias {bias}; the motion changes {change}");
    assert!(error < 0.03 && bias.abs() < 0.01, "{error}, {bias}");
    assert!(change > 0.1, "{change}");
    renderer.gpu().check().unwrap();
}
