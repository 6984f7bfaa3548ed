//! The Cornell box, from the measurements that the Cornell University Program of Computer
//! Graphics published ("Cornell Box Data"): corners in millimetres, measured wall spectra (here
//! as linear sRGB reflectances), camera. Ten times the true size, so that it is a room of
//! 5.5 m by 5.5 m by 5.6 m; turned so that the camera looks along −z, as glTF's cameras do.
//!
//! The lamp behind the opening in the ceiling is a spot light here.

use super::matt;
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::DVec3;
use rebounce_shared::camera::Camera;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::light::Light;

const WHITE: u32 = 0;
const RED: u32 = 1;
const GREEN: u32 = 2;

type Quad = [[f64; 3]; 4];

/// Millimetres as published: x to the picture's left, y up, z into the picture.
const WALLS: [(u32, Quad); 5] = [
    (WHITE, [[552.8, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [549.6, 0.0, 559.2]]),
    (WHITE, [[556.0, 548.8, 0.0], [556.0, 548.8, 559.2], [0.0, 548.8, 559.2], [0.0, 548.8, 0.0]]),
    (WHITE, [[549.6, 0.0, 559.2], [0.0, 0.0, 559.2], [0.0, 548.8, 559.2], [556.0, 548.8, 559.2]]),
    (GREEN, [[0.0, 0.0, 559.2], [0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 548.8, 559.2]]),
    (RED, [[552.8, 0.0, 0.0], [549.6, 0.0, 559.2], [556.0, 548.8, 559.2], [556.0, 548.8, 0.0]]),
];

const SHORT_BLOCK: [Quad; 5] = [
    [[130.0, 165.0, 65.0], [82.0, 165.0, 225.0], [240.0, 165.0, 272.0], [290.0, 165.0, 114.0]],
    [[290.0, 0.0, 114.0], [290.0, 165.0, 114.0], [240.0, 165.0, 272.0], [240.0, 0.0, 272.0]],
    [[130.0, 0.0, 65.0], [130.0, 165.0, 65.0], [290.0, 165.0, 114.0], [290.0, 0.0, 114.0]],
    [[82.0, 0.0, 225.0], [82.0, 165.0, 225.0], [130.0, 165.0, 65.0], [130.0, 0.0, 65.0]],
    [[240.0, 0.0, 272.0], [240.0, 165.0, 272.0], [82.0, 165.0, 225.0], [82.0, 0.0, 225.0]],
];

const TALL_BLOCK: [Quad; 5] = [
    [[423.0, 330.0, 247.0], [265.0, 330.0, 296.0], [314.0, 330.0, 456.0], [472.0, 330.0, 406.0]],
    [[423.0, 0.0, 247.0], [423.0, 330.0, 247.0], [472.0, 330.0, 406.0], [472.0, 0.0, 406.0]],
    [[472.0, 0.0, 406.0], [472.0, 330.0, 406.0], [314.0, 330.0, 456.0], [314.0, 0.0, 456.0]],
    [[314.0, 0.0, 456.0], [314.0, 330.0, 456.0], [265.0, 330.0, 296.0], [265.0, 0.0, 296.0]],
    [[265.0, 0.0, 296.0], [265.0, 330.0, 296.0], [423.0, 330.0, 247.0], [423.0, 0.0, 247.0]],
];

/// Published coordinates to the scene's: centred between the walls, the open front at z = 0.
fn place([x, y, z]: [f64; 3]) -> DVec3 {
    DVec3::new(278.0 - x, y, -z) * 0.01
}

pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    for (material, corners) in WALLS {
        mesh.quad(corners.map(place), material);
    }
    for corners in SHORT_BLOCK.into_iter().chain(TALL_BLOCK) {
        mesh.quad(corners.map(place), WHITE);
    }
    let mut scene = Scene {
        name: "cornell-box".into(),
        materials: vec![
            matt("white", [0.73, 0.73, 0.73]),
            matt("red", [0.63, 0.065, 0.05]),
            matt("green", [0.14, 0.45, 0.091]),
        ],
        lights: vec![Light::Spot {
            // Just under the middle of the opening, 343..213 by 227..332 mm.
            position: place([278.0, 540.0, 279.5]).to_array(),
            direction: [0.0, -1.0, 0.0],
            outer_cone_deg: 60.0,
            inner_cone_deg: Some(50.0),
            intensity: 120.0,
            color: [1.0, 0.85, 0.65],
            radius: 0.0,
        }],
        cameras: vec![Camera {
            position: place([278.0, 273.0, -800.0]).to_array(),
            target: place([278.0, 273.0, 279.6]).to_array(),
            up: [0.0, 1.0, 0.0],
            // A lens of 35 mm before a picture of 25 mm.
            yfov_deg: 2.0 * (12.5f64 / 35.0).arc_tangent().to_degrees(),
        }],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}
