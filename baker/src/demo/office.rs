//! An office after Fig. 14 of Dachsbacher et al. 2007: the sun comes through a window and lights a part of the opposite
//! wall; desks, chairs and shelves have hardly any light but what bounced. Metres.

use super::{block, camera, matt};
use crate::random::Stream;
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};
use rebounce_shared::light::Light;

const FLOOR: u32 = 0;
const WALL: u32 = 1;
const WOOD: u32 = 2;
const GREY: u32 = 3;
const FABRIC: u32 = 4;
const FIRST_FILE: u32 = 5;
const FILES: [[f32; 3]; 4] = [[0.55, 0.14, 0.1], [0.12, 0.25, 0.5], [0.6, 0.5, 0.2], [0.62, 0.62, 0.6]];

/// Width (x), height (y) and depth (z) of the room.
const ROOM: DVec3 = dvec3(6.0, 2.8, 4.6);
/// Ranges of y and z of the window in the wall x = 0.
const WINDOW: [[f64; 2]; 2] = [[1.0, 2.3], [1.2, 3.2]];

pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    room(&mut mesh);
    for x in [2.2, 4.3] {
        desk(&mut mesh, dvec3(x, 0.0, 2.9));
        chair(&mut mesh, dvec3(x - 0.1, 0.0, 2.1));
    }
    chair(&mut mesh, dvec3(0.7, 0.0, 0.8));
    shelf(&mut mesh, 1.4, 3.4);
    shelf(&mut mesh, 3.9, 5.5);
    // A cabinet below the window, and a bin.
    block(&mut mesh, dvec3(0.02, 0.0, 1.4), dvec3(0.45, 0.7, 3.0), GREY);
    block(&mut mesh, dvec3(3.2, 0.0, 3.2), dvec3(3.5, 0.35, 3.5), FABRIC);
    let mut materials = vec![
        matt("floor", [0.42, 0.36, 0.3]),
        matt("wall", [0.76, 0.75, 0.72]),
        matt("wood", [0.5, 0.36, 0.22]),
        matt("grey", [0.5, 0.51, 0.53]),
        matt("fabric", [0.16, 0.22, 0.3]),
    ];
    materials.extend(FILES.iter().enumerate().map(|(i, colour)| matt(&format!("file {i}"), *colour)));
    let mut scene = Scene {
        name: "office".into(),
        materials,
        lights: vec![Light::Directional {
            direction: [1.0, -0.12, 0.05],
            intensity: 30.0,
            color: [1.0, 0.94, 0.85],
            radius_deg: 0.0,
        }],
        cameras: vec![camera(dvec3(0.5, 1.75, 4.35), dvec3(3.6, 0.85, 1.5), 62.0)],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}

/// Floor, ceiling and walls; the left one has the window.
fn room(mesh: &mut WorldMesh) {
    let mut walls = WorldMesh::default();
    walls.room(DVec3::ZERO, ROOM, [FLOOR, WALL, WALL, WALL, WALL, WALL]);
    // The first face is the left wall, the second one the floor.
    for (number, corners) in walls.positions.chunks_exact(4).enumerate() {
        let material = if number == 1 { FLOOR } else { WALL };
        if number != 0 {
            mesh.quad([corners[0], corners[1], corners[2], corners[3]], material);
        }
    }
    let [[low, high], [back, front]] = WINDOW;
    let mut wall = |y: [f64; 2], z: [f64; 2]| {
        let corner = |y: f64, z: f64| dvec3(0.0, y, z);
        // Seen from +x.
        mesh.quad([corner(y[0], z[0]), corner(y[1], z[0]), corner(y[1], z[1]), corner(y[0], z[1])], WALL);
    };
    wall([0.0, low], [0.0, ROOM.z]);
    wall([high, ROOM.y], [0.0, ROOM.z]);
    wall([low, high], [0.0, back]);
    wall([low, high], [front, ROOM.z]);
}

/// A desk with two side boards, drawers, a screen on its stand and a keyboard; `at` is below its middle.
fn desk(mesh: &mut WorldMesh, at: DVec3) {
    let mut add = |low: [f64; 3], high: [f64; 3], material: u32| {
        block(mesh, at + DVec3::from(low), at + DVec3::from(high), material);
    };
    add([-0.8, 0.7, -0.4], [0.8, 0.74, 0.4], WOOD);
    add([-0.78, 0.0, -0.36], [-0.74, 0.7, 0.36], GREY);
    add([0.74, 0.0, -0.36], [0.78, 0.7, 0.36], GREY);
    for drawer in 0..3 {
        let y = 0.08 + 0.2 * f64::from(drawer);
        add([0.34, y, -0.34], [0.73, y + 0.18, 0.3], WOOD);
    }
    add([-0.28, 0.84, 0.18], [0.28, 1.2, 0.22], FABRIC);
    add([-0.03, 0.75, 0.2], [0.03, 0.84, 0.24], GREY);
    add([-0.14, 0.74, 0.12], [0.14, 0.755, 0.3], GREY);
    add([-0.25, 0.74, -0.25], [0.22, 0.765, -0.08], GREY);
}

/// A chair on four legs that looks towards greater z; `at` is below its middle.
fn chair(mesh: &mut WorldMesh, at: DVec3) {
    let mut add = |low: [f64; 3], high: [f64; 3], material: u32| {
        block(mesh, at + DVec3::from(low), at + DVec3::from(high), material);
    };
    for (x, z) in [(-0.2, -0.2), (0.2, -0.2), (-0.2, 0.2), (0.2, 0.2)] {
        add([x - 0.02, 0.0, z - 0.02], [x + 0.02, 0.43, z + 0.02], GREY);
    }
    add([-0.23, 0.43, -0.23], [0.23, 0.48, 0.23], FABRIC);
    add([-0.21, 0.6, -0.25], [0.21, 0.95, -0.21], FABRIC);
    for x in [-0.19, 0.19] {
        add([x - 0.015, 0.48, -0.24], [x + 0.015, 0.6, -0.21], GREY);
    }
}

/// Shelves along the wall z = 0, from x = `left` to `right`, with files.
fn shelf(mesh: &mut WorldMesh, left: f64, right: f64) {
    const BOARD: f64 = 0.03;
    const DEPTH: f64 = 0.35;
    let mut stream = Stream::new(7, left.to_bits());
    let mut between = |low: f64, high: f64| low + (high - low) * f64::from(stream.unit());
    for x in [left, right - BOARD] {
        block(mesh, dvec3(x, 0.0, 0.01), dvec3(x + BOARD, 2.0, DEPTH), WOOD);
    }
    for row in 0..5 {
        let y = 0.06 + 0.48 * f64::from(row);
        let (from, to) = (left + BOARD, right - BOARD);
        block(mesh, dvec3(from, y, 0.01), dvec3(to, y + BOARD, DEPTH - 0.01), WOOD);
        let mut x = from + between(0.02, 0.3);
        while row < 4 && x < to - 0.3 {
            // Files of one colour stand side by side.
            let (low, width) = (dvec3(x, y + BOARD, 0.03), between(0.16, 0.5).min(to - x - 0.02));
            let high = dvec3(x + width, y + BOARD + 0.31, between(0.29, 0.32));
            let file = (between(0.0, FILES.len() as f64) as u32).min(FILES.len() as u32 - 1);
            block(mesh, low, high, FIRST_FILE + file);
            x += width + between(0.08, 0.3);
        }
    }
}
