//! A bare room, 5 m by 4 m and 2.6 m high, lit by the sun through a single small window: all bounced light comes from a
//! patch on the floor and a wall. Bare walls show the slightest spot. Metres; walls are 20 cm thick.

use super::{block, camera, matt};
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};
use rebounce_shared::light::Light;

const ROOM: DVec3 = dvec3(5.0, 2.6, 4.0);
const WALL: f64 = 0.2;
/// The window: range of heights, and range along the wall.
const WINDOW: [[f64; 2]; 2] = [[0.9, 1.6], [1.6, 2.3]];

/// Cameras look at bare walls.
pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    let (low, high) = (DVec3::splat(-WALL), ROOM + DVec3::splat(WALL));
    block(&mut mesh, low, dvec3(high.x, 0.0, high.z), 0);
    block(&mut mesh, dvec3(low.x, ROOM.y, low.z), high, 0);
    block(&mut mesh, dvec3(low.x, 0.0, low.z), dvec3(high.x, ROOM.y, 0.0), 0);
    block(&mut mesh, dvec3(low.x, 0.0, ROOM.z), dvec3(high.x, ROOM.y, high.z), 0);
    block(&mut mesh, dvec3(low.x, 0.0, 0.0), dvec3(0.0, ROOM.y, ROOM.z), 0);
    // Around the window.
    let [[sill, head], [near, far]] = WINDOW;
    let mut piece = |from: [f64; 2], to: [f64; 2]| {
        block(&mut mesh, dvec3(ROOM.x, from[0], from[1]), dvec3(high.x, to[0], to[1]), 0);
    };
    piece([0.0, 0.0], [sill, ROOM.z]);
    piece([head, 0.0], [ROOM.y, ROOM.z]);
    piece([sill, 0.0], [head, near]);
    piece([sill, far], [head, ROOM.z]);
    let look = |position: [f64; 3], target: [f64; 3]| camera(position, target, 60.0);
    let mut scene = Scene {
        name: "attic".into(),
        materials: vec![matt("plaster", [0.7, 0.68, 0.62])],
        lights: vec![Light::Directional {
            direction: [-0.8, -0.7, -0.1],
            intensity: 50.0,
            color: [1.0, 0.95, 0.85],
            radius_deg: 0.0,
        }],
        cameras: vec![look([4.6, 1.5, 0.5], [0.0, 1.2, 3.2]), look([4.6, 1.3, 3.5], [0.0, 1.2, 0.6])],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}
