//! A trophy of rough metal in the open: a ring and three balls on a plinth, between a red board and a white step. What it
//! reflects is near it as well as far away.

use super::sky::add_clear_sky;
use super::{block, camera, matt};
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, Vec2, dvec3};
use rebounce_shared::elementary::Elementary;
use rebounce_shared::rbn::meta::Material;
use std::f64::consts::{PI, TAU};

const METAL: u32 = 0;
const GROUND: u32 = 1;
const PLINTH: u32 = 2;
const BOARD: u32 = 3;
const STEP: u32 = 4;

/// Squares around and along a ball, and around the ring's tube and the ring.
const BALL: [u32; 2] = [40, 20];
const RING: [usize; 2] = [24, 64];
/// Middle of the ring, its radius and that of its tube, metres.
const MIDDLE: DVec3 = dvec3(0.0, 1.2, 0.0);
const RADII: [f64; 2] = [0.34, 0.09];

pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    let corner = |x: f64, z: f64| dvec3(4.0 * x, 0.0, 4.0 * z);
    mesh.quad([corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)], GROUND);
    block(&mut mesh, dvec3(-0.3, 0.0, -0.3), dvec3(0.3, 0.5, 0.3), PLINTH);
    block(&mut mesh, dvec3(-0.9, 0.0, -0.7), dvec3(-0.84, 1.8, 0.7), BOARD);
    block(&mut mesh, dvec3(0.7, 0.0, -0.8), dvec3(1.7, 0.6, 0.8), STEP);
    ring(&mut mesh);
    let top = MIDDLE.y + RADII[0] + RADII[1];
    for (y, radius) in [(0.64, 0.15), (MIDDLE.y, 0.15), (top + 0.08, 0.1)] {
        ball(&mut mesh, dvec3(0.0, y, 0.0), radius);
    }
    let metal = Material { metallic: 1.0, roughness: 0.4, specular: 0.5, ..matt("metal", [0.9, 0.72, 0.45]) };
    let mut scene = Scene {
        name: "trophy".into(),
        materials: vec![
            metal,
            matt("ground", [0.35, 0.34, 0.32]),
            matt("plinth", [0.55, 0.54, 0.5]),
            matt("red", [0.62, 0.08, 0.06]),
            matt("white", [0.78, 0.78, 0.76]),
        ],
        cameras: vec![camera([0.9, 1.5, 2.6], [0.0, 1.05, 0.0], 34.0)],
        ..Scene::default()
    };
    add_clear_sky(&mut scene, [0.5, -1.0, -0.7], 0.3);
    mesh.finish(&mut scene);
    scene
}

/// A ring that stands upright, seen from the front as a circle.
fn ring(mesh: &mut WorldMesh) {
    let at = |tube: f64, around: f64| {
        let ((sin, cos), (up, out)) = ((TAU * around).sine_cosine(), (TAU * tube).sine_cosine());
        let outward = dvec3(cos, sin, 0.0);
        let normal = out * outward + up * DVec3::Z;
        (MIDDLE + RADII[0] * outward + RADII[1] * normal, normal)
    };
    mesh.sheet(RING, at, METAL);
}

fn ball(mesh: &mut WorldMesh, middle: DVec3, radius: f64) {
    let [columns, rows] = BALL;
    let first = mesh.positions.len() as u32;
    for row in 0..=rows {
        for column in 0..=columns {
            let (out, up) = (PI * f64::from(row) / f64::from(rows)).sine_cosine();
            let (sin, cos) = (TAU * f64::from(column) / f64::from(columns)).sine_cosine();
            let normal = dvec3(out * cos, up, -out * sin);
            mesh.positions.push(middle + radius * normal);
            mesh.normals.push(normal.as_vec3());
            mesh.uvs.push(Vec2::ZERO);
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let a = first + row * (columns + 1) + column;
            let [b, c, d] = [a + 1, a + columns + 2, a + columns + 1];
            // One triangle a column at the poles.
            mesh.triangles.extend((row > 0).then_some([a, d, b]));
            mesh.triangles.extend((row + 1 < rows).then_some([b, d, c]));
        }
    }
    mesh.triangle_material.resize(mesh.triangles.len(), METAL);
}
