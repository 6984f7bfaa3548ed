//! A maze of low walls in a hall, after Fig. 12 of Dachsbacher et al. 2007: the sun comes through a slot of the ceiling and
//! lights the wall behind the viewer. All light and all shadows in sight are indirect. Metres.

use super::{block, camera, matt};
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};
use rebounce_shared::light::Light;

/// Width (x), height (y) and depth (z) of the hall.
const HALL: DVec3 = dvec3(8.0, 3.0, 8.0);
/// Ranges of x and z of the slot in the ceiling.
const SLOT: [[f64; 2]; 2] = [[0.8, 7.2], [6.5, 7.1]];
/// Height and half the thickness of the maze's walls.
const TALL: f64 = 1.3;
const HALF: f64 = 0.08;
/// Middle lines of the maze's walls: from x, z to x, z.
const WALLS: [[f64; 4]; 13] = [
    [1.2, 0.9, 3.2, 0.9],
    [4.4, 0.9, 6.8, 0.9],
    [1.2, 0.9, 1.2, 3.6],
    [6.8, 0.9, 6.8, 2.6],
    [2.4, 2.1, 4.4, 2.1],
    [4.4, 0.9, 4.4, 2.1],
    [5.6, 2.1, 5.6, 3.9],
    [2.4, 2.1, 2.4, 4.8],
    [3.6, 3.3, 5.6, 3.3],
    [1.2, 4.8, 2.4, 4.8],
    [3.6, 3.3, 3.6, 5.0],
    [4.8, 4.6, 6.8, 4.6],
    [6.8, 3.6, 6.8, 5.4],
];

pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    hall(&mut mesh);
    for (number, [x0, z0, x1, z1]) in WALLS.into_iter().enumerate() {
        // Where walls meet, one is as high as the other and ends at its side.
        let (low, high) = (dvec3(x0.min(x1), 0.0, z0.min(z1)), dvec3(x0.max(x1), TALL, z0.max(z1)));
        let across = if x0 == x1 { dvec3(HALF, 0.0, -HALF) } else { dvec3(HALF, 0.0, HALF) };
        block(
            &mut mesh,
            low - across,
            high + across,
            1 + u32::from(number % 4 == 1) + 2 * u32::from(number % 4 == 3),
        );
    }
    let mut scene = Scene {
        name: "maze".into(),
        materials: vec![
            matt("hall", [0.75, 0.73, 0.7]),
            matt("wall", [0.7, 0.7, 0.68]),
            matt("red", [0.62, 0.2, 0.14]),
            matt("blue", [0.16, 0.28, 0.55]),
        ],
        lights: vec![Light::Directional {
            direction: [0.0, -1.0, 0.9],
            intensity: 60.0,
            color: [1.0, 0.94, 0.85],
            radius_deg: 0.0,
        }],
        cameras: vec![camera(dvec3(4.0, 2.75, 7.6), dvec3(4.0, 0.3, 2.9), 55.0)],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}

/// The hall, its ceiling around the slot.
fn hall(mesh: &mut WorldMesh) {
    let [[left, right], [back, front]] = SLOT;
    let mut walls = WorldMesh::default();
    walls.room(DVec3::ZERO, HALL, [0; 6]);
    // The fifth face is the ceiling.
    for (number, corners) in walls.positions.chunks_exact(4).enumerate() {
        if number != 4 {
            mesh.quad([corners[0], corners[1], corners[2], corners[3]], 0);
        }
    }
    let mut ceiling = |x: [f64; 2], z: [f64; 2]| {
        let corner = |x: f64, z: f64| dvec3(x, HALL.y, z);
        // Seen from below.
        mesh.quad([corner(x[0], z[0]), corner(x[1], z[0]), corner(x[1], z[1]), corner(x[0], z[1])], 0);
    };
    ceiling([0.0, HALL.x], [0.0, back]);
    ceiling([0.0, HALL.x], [front, HALL.z]);
    ceiling([0.0, left], [back, front]);
    ceiling([right, HALL.x], [back, front]);
}
