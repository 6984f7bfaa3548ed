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

const SIZE: [u32; 2] = [64, 48];
const DOOR_SIZE: [u32; 2] = [48, 36];

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
#[ignore = "takes much processor time: docs/dev/testing.md"]
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
    renderer.move_nodes(&moved).unwrap();
    let ours = common::indirect(&mut renderer, SIZE);
    assert!(!renderer.is_solving());
    let motions = Motions::new(&scene.groups, &moved, scene.meta.origin);
    let picture = |motions: &Motions| {
        let surfaces = TriangleSurfaces::from_moved(&scene, motions).unwrap();
        let lighting = Lighting::new(std::slice::from_ref(&light), None, scene.meta.origin, 0);
        let relit = Relit::moved(&scene, &surfaces, lighting, true, motions);
        let exposure = Exposure { size: SIZE, samples: 128, seed: 3 };
        relit.picture(&scene, &surfaces, &camera, exposure, Only::Indirect, || ()).pixels
    };
    // The GPU solves once, in software most of this test's time: what is left of an earlier place is the door's law.
    let at_rest = picture(&Motions::new(&scene.groups, &[], scene.meta.origin));
    let (error, bias) = common::difference(&ours, &picture(&motions));
    let (change, _) = common::difference(&ours, &at_rest);
    println!("error {error}, bias {bias}; the motion changes {change}");
    assert!(error < 0.03 && bias.abs() < 0.01, "{error}, {bias}");
    assert!(change > 0.1, "{change}");
    renderer.gpu().check().unwrap();
}

#[test]
fn a_door_in_the_viewer_is_the_cpus_and_a_wall_where_it_is_closed() {
    for (name, [closed, open]) in
        [("builtin:two-rooms-leaf", [0.0, 80.0]), ("builtin:two-rooms-leaf-open", [-80.0, 0.0])]
    {
        let room = rebounce::io::load(name).unwrap();
        let mut settings = settings(900);
        settings.solver = BakeSolver::Radiosity;
        let scene = bake(&room, &settings.normalised(), &()).unwrap().0;
        let Some(mut renderer) = common::renderer(&scene) else { return };
        let lights = scene.meta.lights.clone();
        renderer.set_lights(lights.clone()).unwrap();
        let [dark, lit] = [0, 1].map(|k| scene.meta.cameras[k].clone());
        let mut shown = |rotation_y_deg: f64| {
            let turn = NodeMotion { rotation_y_deg, ..NodeMotion::default() };
            renderer.move_nodes(&[turn]).unwrap();
            [&dark, &lit].map(|camera| {
                renderer.set_camera(camera.clone()).unwrap();
                common::indirect(&mut renderer, DOOR_SIZE)
            })
        };
        let truth = |rotation_y_deg: f64| {
            let turn = NodeMotion { rotation_y_deg, ..NodeMotion::default() };
            let motions = Motions::new(&scene.groups, &[turn], scene.meta.origin);
            let surfaces = TriangleSurfaces::from_moved(&scene, &motions).unwrap();
            let lighting = Lighting::new(&lights, None, scene.meta.origin, 0);
            let relit = Relit::moved(&scene, &surfaces, lighting, true, &motions);
            [&dark, &lit].map(|camera| {
                let exposure = Exposure { size: DOOR_SIZE, samples: 64, seed: 3 };
                relit.picture(&scene, &surfaces, camera, exposure, Only::Indirect, || ()).pixels
            })
        };
        // To and fro: nothing of one place is left in the next.
        let (at_closed, at_open, again) = (shown(closed), shown(open), shown(closed));
        assert!(at_closed == again, "{name}: the light is not what it was before the leaf moved");
        let (true_closed, true_open) = (truth(closed), truth(open));
        for (what, ours, truth) in [
            ("closed", &at_closed[1], &true_closed[1]),
            ("open, dark room", &at_open[0], &true_open[0]),
            ("open, lit room", &at_open[1], &true_open[1]),
        ] {
            let (error, bias) = common::difference(ours, truth);
            println!("{name}, {what}: error {error}, bias {bias}");
            assert!(error < 0.04 && bias.abs() < 0.01, "{name}, {what}: {error}, {bias}");
        }
        let mean = |pixels: &[glam::Vec3]| pixels.iter().map(|p| p.element_sum()).sum::<f32>();
        for (side, leak) in [
            ("viewer", mean(&at_closed[0]) / mean(&at_closed[1])),
            ("CPU", mean(&true_closed[0]) / mean(&true_closed[1])),
        ] {
            println!("{name}, {side}: {leak}");
            assert!(leak <= 5e-3, "{name}, {side}: {leak}");
        }
        assert!(mean(&at_open[0]) > 0.05 * mean(&at_open[1]), "no light comes through the open door");
        renderer.gpu().check().unwrap();
    }
}
