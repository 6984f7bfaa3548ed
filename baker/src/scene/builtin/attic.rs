//! A bare room under a roof, with thick walls, lit by the sun through one small window: nothing but smooth light on bare walls,
//! all of it from a patch of the floor and one of the wall. Metres.

use super::super::{Scene, WorldMesh};
use super::{block, matt};
use glam::{DVec3, dvec3};
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;

/// Length (x), height of the ridge (y) and width (z).
const ROOM: DVec3 = dvec3(5.0, 3.0, 4.4);
/// Height of the walls that the roof rests on.
const KNEE: f64 = 1.2;
/// Thickness of walls and roof.
const THICK: f64 = 0.2;
/// Least and greatest y and z of the window, in the wall at the greatest x.
const WINDOW: [[f64; 2]; 2] = [[1.0, 1.7], [1.7, 2.4]];

/// The first camera looks at the wall and the roof on one side, the second one at the other end.
pub(super) fn scene() -> Scene {
    let DVec3 { x, y, z } = ROOM;
    let mut mesh = WorldMesh::default();
    let mut wall = |low: [f64; 3], high: [f64; 3], material| {
        block(&mut mesh, DVec3::from(low), DVec3::from(high), material);
    };
    let t = THICK;
    wall([-t, -t, -t], [x + t, 0.0, z + t], 1);
    wall([0.0, 0.0, -t], [x, KNEE, 0.0], 0);
    wall([0.0, 0.0, z], [x, KNEE, z + t], 0);
    wall([-t, 0.0, -t], [0.0, y + t, z + t], 0);
    let [[low, high], [near, far]] = WINDOW;
    wall([x, 0.0, -t], [x + t, low, z + t], 0);
    wall([x, high, -t], [x + t, y + t, z + t], 0);
    wall([x, low, -t], [x + t, high, near], 0);
    wall([x, low, far], [x + t, high, z + t], 0);
    roof(&mut mesh, 0.0);
    roof(&mut mesh, z);
    let look = |position: DVec3, target: DVec3| Camera {
        position: position.to_array(),
        target: target.to_array(),
        up: [0.0, 1.0, 0.0],
        yfov_deg: 60.0,
    };
    let mut scene = Scene {
        name: "attic".into(),
        materials: vec![matt("plaster", [0.7, 0.68, 0.62]), matt("boards", [0.5, 0.36, 0.22])],
        lights: vec![Light::Directional {
            direction: [-0.8, -0.7, -0.1],
            intensity: 50.0,
            color: [1.0, 0.95, 0.85],
        }],
        cameras: vec![
            look(dvec3(4.4, 1.5, 0.6), dvec3(1.2, 1.3, 4.4)),
            look(dvec3(4.6, 1.5, 1.2), dvec3(0.0, 1.4, 2.6)),
        ],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}

/// Half of the roof, from the wall at z = `eaves` to the ridge.
fn roof(mesh: &mut WorldMesh, eaves: f64) {
    let (x, ridge, middle) = (ROOM.x, ROOM.y, 0.5 * ROOM.z);
    let mut within =
        [dvec3(0.0, KNEE, eaves), dvec3(x, KNEE, eaves), dvec3(x, ridge, middle), dvec3(0.0, ridge, middle)];
    if eaves > middle {
        // Counter-clockwise seen from below.
        within.reverse();
    }
    let [a, b, c, d] = within.map(|p| p + THICK * DVec3::Y);
    mesh.quad(within, 0);
    mesh.quad([d, c, b, a], 0);
    let outside = [a, b, c, d];
    for k in 0..4 {
        let next = (k + 1) % 4;
        mesh.quad([within[next], within[k], outside[k], outside[next]], 0);
    }
}
