//! Two rooms, 4 m by 4 m and 2.5 m high, with a dividing wall 5 cm thick: leaks through the wall are visible. Floor,
//! ceiling and long walls run on under and past the dividing wall, as modellers leave them.

use super::{block, camera, matt};
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};
use rebounce_shared::light::Light;

const HALF_WALL: f64 = 0.025;
const DEPTH: f64 = 4.0;
const HEIGHT: f64 = 2.5;
const END: f64 = 4.0 + HALF_WALL;

/// The lamp is in the left room; the first camera looks into the right room. With a `door`, 0.9 m wide and 2 m high,
/// light reaches the right room.
pub(super) fn scene(door: bool) -> Scene {
    let mut mesh = WorldMesh::default();
    mesh.room(dvec3(-END, 0.0, 0.0), dvec3(END, HEIGHT, DEPTH), [0, 1, 1, 2, 3, 1]);
    let wall = |mesh: &mut WorldMesh, low: [f64; 2], high: [f64; 2]| {
        block(mesh, dvec3(-HALF_WALL, low[0], low[1]), dvec3(HALF_WALL, high[0], high[1]), 1);
    };
    if door {
        wall(&mut mesh, [0.0, 0.0], [HEIGHT, 1.0]);
        wall(&mut mesh, [0.0, 1.9], [HEIGHT, DEPTH]);
        wall(&mut mesh, [2.0, 1.0], [HEIGHT, 1.9]);
    } else {
        wall(&mut mesh, [0.0, 0.0], [HEIGHT, DEPTH]);
    }
    let look = |position: DVec3, target: DVec3| camera(position, target, 65.0);
    let mut scene = Scene {
        name: if door { "two-rooms-door" } else { "two-rooms" }.into(),
        materials: vec![
            matt("floor", [0.45, 0.32, 0.2]),
            matt("white", [0.75, 0.75, 0.72]),
            matt("red", [0.6, 0.12, 0.1]),
            matt("blue", [0.1, 0.2, 0.6]),
        ],
        lights: vec![Light::Spot {
            position: [-2.2, 2.3, 2.6],
            direction: [0.5, -1.0, -0.55],
            outer_cone_deg: 55.0,
            inner_cone_deg: Some(45.0),
            intensity: 60.0,
            color: [1.0, 0.92, 0.8],
            radius: 0.0,
        }],
        cameras: vec![
            look(dvec3(3.6, 1.6, 3.6), dvec3(0.2, 1.0, 0.9)),
            look(dvec3(-3.6, 1.6, 3.6), dvec3(-0.2, 1.0, 0.9)),
        ],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}
