//! A small library: shelves full of books, a table on thin legs, slats before a window. Fine detail,
//! contact shadows, many colours.

use super::{block, matt};
use crate::random::Stream;
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;

const FLOOR: u32 = 0;
const WALL: u32 = 1;
const WOOD: u32 = 2;
const WHITE: u32 = 3;
const FIRST_BOOK: u32 = 4;
const BOOKS: [[f32; 3]; 6] = [
    [0.5, 0.1, 0.08],
    [0.08, 0.2, 0.42],
    [0.1, 0.32, 0.14],
    [0.62, 0.48, 0.16],
    [0.3, 0.14, 0.34],
    [0.66, 0.62, 0.52],
];

/// Width (x), height (y) and depth (z) of the room, metres.
const ROOM: DVec3 = dvec3(4.5, 2.6, 3.8);

pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    mesh.room(DVec3::ZERO, ROOM, [FLOOR, WALL, WALL, WALL, WALL, WALL]);
    shelf(&mut mesh, 0.5, 4.0);
    table(&mut mesh, dvec3(2.5, 0.0, 1.9));
    slats(&mut mesh);
    let mut materials = vec![
        matt("floor", [0.36, 0.22, 0.12]),
        matt("wall", [0.72, 0.7, 0.66]),
        matt("wood", [0.42, 0.27, 0.14]),
        matt("white", [0.8, 0.8, 0.8]),
    ];
    materials.extend(BOOKS.iter().enumerate().map(|(i, colour)| matt(&format!("book {i}"), *colour)));
    let mut scene = Scene {
        name: "library".into(),
        materials,
        lights: vec![Light::Spot {
            position: [3.6, 2.4, 3.0],
            direction: [-0.45, -1.0, -0.75],
            outer_cone_deg: 42.0,
            inner_cone_deg: Some(36.0),
            intensity: 60.0,
            color: [1.0, 0.9, 0.76],
            radius: 0.0,
        }],
        cameras: vec![Camera {
            position: [3.9, 1.6, 3.5],
            target: [1.9, 0.9, 0.6],
            up: [0.0, 1.0, 0.0],
            yfov_deg: 60.0,
        }],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}

/// A bookcase along the wall z = 0, from x = `left` to `right`.
fn shelf(mesh: &mut WorldMesh, left: f64, right: f64) {
    const BOARD: f64 = 0.025;
    const DEPTH: f64 = 0.3;
    const TOP: f64 = 2.1;
    let mut stream = Stream::new(5, 5);
    let mut between = |low: f64, high: f64| low + (high - low) * stream.unit() as f64;
    for x in [left, 0.5 * (left + right), right] {
        block(mesh, dvec3(x - 0.5 * BOARD, 0.0, 0.0), dvec3(x + 0.5 * BOARD, TOP, DEPTH), WOOD);
    }
    for row in 0..6 {
        let y = 0.1 + 0.39 * row as f64;
        for (from, to) in [(left, 0.5 * (left + right)), (0.5 * (left + right), right)] {
            let (from, to) = (from + 0.5 * BOARD, to - 0.5 * BOARD);
            block(mesh, dvec3(from, y, 0.0), dvec3(to, y + BOARD, DEPTH - 0.005), WOOD);
            if row == 5 {
                continue;
            }
            let mut x = from + 0.01;
            while x < to - 0.1 {
                let width = between(0.018, 0.06);
                let low = dvec3(x, y + BOARD, 0.02);
                let high = dvec3(x + width, y + BOARD + between(0.2, 0.33), between(0.2, 0.28));
                let colour = (between(0.0, BOOKS.len() as f64) as u32).min(BOOKS.len() as u32 - 1);
                block(mesh, low, high, FIRST_BOOK + colour);
                x += width + if between(0.0, 1.0) < 0.12 { between(0.03, 0.15) } else { 0.002 };
            }
        }
    }
}

/// A table and two stools on thin legs.
fn table(mesh: &mut WorldMesh, at: DVec3) {
    let stand = |mesh: &mut WorldMesh, at: DVec3, half: [f64; 2], height: f64, leg: f64| {
        let top = dvec3(half[0], 0.03, half[1]);
        let centre = at + dvec3(0.0, height, 0.0);
        block(mesh, centre - top, centre + dvec3(half[0], 0.0, half[1]), WOOD);
        for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
            let foot = at + dvec3(x * (half[0] - leg), 0.0, z * (half[1] - leg));
            let half_leg = dvec3(0.5 * leg, 0.0, 0.5 * leg);
            block(mesh, foot - half_leg, foot + half_leg + dvec3(0.0, height - 0.03, 0.0), WOOD);
        }
    };
    stand(mesh, at, [0.75, 0.4], 0.74, 0.05);
    stand(mesh, at + dvec3(-0.4, 0.0, 0.75), [0.17, 0.17], 0.45, 0.03);
    stand(mesh, at + dvec3(0.5, 0.0, -0.8), [0.17, 0.17], 0.45, 0.03);
    // An open book, a pile and a cup.
    let top = at + dvec3(0.0, 0.74, 0.0);
    for (k, (offset, size)) in [
        (dvec3(-0.45, 0.0, 0.0), dvec3(0.24, 0.03, 0.17)),
        (dvec3(-0.44, 0.03, 0.01), dvec3(0.22, 0.025, 0.15)),
        (dvec3(-0.45, 0.055, -0.01), dvec3(0.2, 0.035, 0.15)),
        (dvec3(0.1, 0.0, -0.1), dvec3(0.3, 0.012, 0.22)),
        (dvec3(0.55, 0.0, 0.1), dvec3(0.08, 0.1, 0.08)),
    ]
    .into_iter()
    .enumerate()
    {
        let material = if k == 3 || k == 4 { WHITE } else { FIRST_BOOK + k as u32 };
        let half = dvec3(0.5 * size.x, 0.0, 0.5 * size.z);
        block(mesh, top + offset - half, top + offset + half + dvec3(0.0, size.y, 0.0), material);
    }
}

/// Slats before the wall x = 0.
fn slats(mesh: &mut WorldMesh) {
    for k in 0..24 {
        let y = 0.7 + 0.06 * k as f64;
        block(mesh, dvec3(0.04, y, 1.0), dvec3(0.09, y + 0.006, 2.8), WHITE);
    }
}
