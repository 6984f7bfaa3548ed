//! A corridor behind a door that is ajar, and the room with the lamp: the corridor's light comes through the gap.
//! Metres.

use super::{block, camera, matt};
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};
use rebounce_shared::elementary::Elementary;
use rebounce_shared::light::Light;

/// Depth (z) of the room, width (x) of room and corridor, height (y).
const ROOM: f64 = 4.0;
const LENGTH: f64 = 7.0;
const HEIGHT: f64 = 2.6;
/// Width of the corridor (−z), and thickness of the wall before it.
const WIDTH: f64 = 1.7;
const WALL: f64 = 0.12;
/// The door: range of x, height, thickness, and opening angle, degrees.
const DOOR: [f64; 2] = [1.2, 2.1];
const DOOR_HEIGHT: f64 = 2.05;
const LEAF: f64 = 0.04;
const AJAR: f64 = 25.0;

/// The first camera looks along the corridor, the second one into the room.
pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    mesh.room(dvec3(0.0, 0.0, -WALL - WIDTH), dvec3(LENGTH, HEIGHT, ROOM), [0, 1, 1, 2, 3, 1]);
    for (from, to, low) in [(0.0, DOOR[0], 0.0), (DOOR[1], LENGTH, 0.0), (DOOR[0], DOOR[1], DOOR_HEIGHT)] {
        block(&mut mesh, dvec3(from, low, -WALL), dvec3(to, HEIGHT, 0.0), 1);
    }
    door(&mut mesh);
    // A chest and a box in the corridor, a table in the room.
    block(&mut mesh, dvec3(3.6, 0.0, -WALL - 0.4), dvec3(4.6, 0.8, -WALL), 4);
    block(&mut mesh, dvec3(5.3, 0.0, -WALL - WIDTH + 0.1), dvec3(5.8, 0.45, -WALL - WIDTH + 0.55), 3);
    block(&mut mesh, dvec3(3.4, 0.7, 1.6), dvec3(5.0, 0.75, 2.6), 4);
    let look = |position: DVec3, target: DVec3| camera(position, target, 65.0);
    let mut scene = Scene {
        name: "corridor".into(),
        materials: vec![
            matt("floor", [0.45, 0.32, 0.2]),
            matt("wall", [0.75, 0.73, 0.68]),
            matt("blue", [0.14, 0.24, 0.42]),
            matt("ochre", [0.6, 0.42, 0.14]),
            matt("wood", [0.36, 0.22, 0.12]),
        ],
        lights: vec![Light::Spot {
            position: [4.6, 2.4, 2.4],
            direction: [-0.2, -1.0, 0.3],
            outer_cone_deg: 60.0,
            inner_cone_deg: Some(50.0),
            intensity: 60.0,
            color: [1.0, 0.9, 0.76],
            radius: 0.0,
        }],
        cameras: vec![
            look(dvec3(6.6, 1.6, -1.4), dvec3(1.5, 1.1, -0.8)),
            look(dvec3(0.5, 1.6, 3.6), dvec3(4.5, 0.9, 0.5)),
        ],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}

/// The door's leaf, hung at the least x and opened into the corridor.
fn door(mesh: &mut WorldMesh) {
    let (sin, cos) = AJAR.to_radians().sine_cosine();
    let (along, across) = (dvec3(cos, 0.0, -sin), dvec3(sin, 0.0, cos));
    let corner = |u: bool, v: bool, y: f64| {
        let hinge = dvec3(DOOR[0] + 0.01, y, -WALL);
        hinge
            + if u { (DOOR[1] - DOOR[0] - 0.02) * along } else { DVec3::ZERO }
            + if v { LEAF * across } else { DVec3::ZERO }
    };
    let (low, high) = (0.01, DOOR_HEIGHT - 0.01);
    let ring = [
        corner(false, true, low),
        corner(true, true, low),
        corner(true, false, low),
        corner(false, false, low),
    ];
    let top = ring.map(|p| dvec3(p.x, high, p.z));
    for k in 0..4 {
        let next = (k + 1) % 4;
        mesh.quad([ring[k], ring[next], top[next], top[k]], 4);
    }
    mesh.quad(top, 4);
    mesh.quad([ring[3], ring[2], ring[1], ring[0]], 4);
}
