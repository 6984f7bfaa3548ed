//! A theatre: a seat of fourteen thousand triangles, with hundreds of instances.

use super::{block, matt};
use crate::scene::Scene;
use crate::scene::model;
use crate::scene::world_mesh::{WorldInstancedMesh, WorldMesh};
use glam::{DMat4, DQuat, DVec2, DVec3, dvec3};
use rebounce_shared::camera::Camera;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::light::Light;

const WALL: u32 = 0;
const FLOOR: u32 = 1;
const VELVET: u32 = 2;
const WOOD: u32 = 3;
const CURTAIN: u32 = 4;

/// Width (x), height (y) and depth (z) of the hall, metres. The stage is at z = 0.
const HALL: DVec3 = dvec3(20.0, 8.0, 26.0);
const STAGE: f64 = 6.0;
const ROWS: usize = 17;
const SEATS: usize = 26;
/// Height and depth of a row's step.
const STEP: DVec2 = DVec2::new(0.16, 1.0);
/// Start of the first row's step in z.
const FIRST: f64 = STAGE + 2.5;
/// Squares around and along a cushion.
const FINE: [usize; 2] = [48, 24];

pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    mesh.room(DVec3::ZERO, HALL, [FLOOR, WALL, WALL, WALL, WALL, WALL]);
    block(&mut mesh, dvec3(0.0, 0.0, 0.0), dvec3(HALL.x, 1.0, STAGE), WOOD);
    for row in 0..ROWS {
        let z = FIRST + STEP.y * row as f64;
        let end = if row + 1 == ROWS { HALL.z } else { z + STEP.y };
        block(&mut mesh, dvec3(0.0, 0.0, z), dvec3(HALL.x, STEP.x * (row + 1) as f64, end), FLOOR);
    }
    curtain(&mut mesh);
    mesh.stand(&seat(), &places());
    let spot = |x: f64, intensity: f64, color| Light::Spot {
        position: [x, 7.4, 12.0],
        direction: [0.35 * (10.0 - x), -5.4, -9.0],
        outer_cone_deg: 26.0,
        inner_cone_deg: Some(20.0),
        intensity,
        color,
        radius: 0.0,
    };
    let camera = |position, target| Camera { position, target, up: [0.0, 1.0, 0.0], yfov_deg: 60.0 };
    let mut scene = Scene {
        name: "theatre".into(),
        materials: vec![
            matt("wall", [0.5, 0.48, 0.44]),
            matt("floor", [0.16, 0.13, 0.11]),
            matt("velvet", [0.36, 0.05, 0.06]),
            matt("wood", [0.34, 0.24, 0.15]),
            matt("curtain", [0.1, 0.14, 0.34]),
        ],
        lights: vec![
            spot(4.0, 500.0, [1.0, 0.86, 0.7]),
            spot(16.0, 400.0, [0.78, 0.88, 1.0]),
            Light::Point {
                position: [10.0, 5.5, 17.0],
                intensity: 60.0,
                color: [1.0, 0.9, 0.75],
                radius: 0.0,
            },
        ],
        cameras: vec![
            camera([5.0, 4.6, 23.0], [11.0, 1.6, 6.0]),
            camera([10.0, 2.6, 2.0], [10.0, 2.0, 16.0]),
        ],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}

impl WorldMesh {
    /// Adds another mesh (without models) at every place: as a model if instancing is worth the cost.
    fn stand(&mut self, other: &Self, places: &[DMat4]) {
        let bounds = other.bounds().unwrap_or_default();
        let mut is_alone = vec![true; places.len()];
        for copies in model::divide(places, other.triangles.len(), bounds) {
            let mut model = WorldInstancedMesh::default();
            model.mesh.add(other, copies.model_from_mesh);
            for (number, world_from_model) in copies.placed {
                is_alone[number] = false;
                model.world_from_model.push(world_from_model);
            }
            self.models.push(model);
        }
        let alone = places.iter().zip(is_alone).filter(|(_, is_alone)| *is_alone);
        alone.for_each(|(place, _)| self.add(other, *place));
    }

    /// Adds another mesh (without models); the matrix may mirror.
    fn add(&mut self, other: &Self, matrix: DMat4) {
        let first = self.positions.len() as u32;
        let is_mirrored = matrix.determinant() < 0.0;
        let normals = matrix.inverse().transpose();
        self.positions.extend(other.positions.iter().map(|p| matrix.transform_point3(*p)));
        let turned = |n: &glam::Vec3| normals.transform_vector3(n.as_dvec3()).normalize_or_zero().as_vec3();
        self.normals.extend(other.normals.iter().map(turned));
        self.uvs.extend(&other.uvs);
        let corners = |&[a, b, c]: &[u32; 3]| if is_mirrored { [a, c, b] } else { [a, b, c] };
        self.triangles.extend(other.triangles.iter().map(|t| corners(t).map(|i| i + first)));
        self.triangle_material.extend(&other.triangle_material);
    }

    /// Adds a box with round edges: a superellipsoid with half axes `half`.
    fn cushion(&mut self, middle: DVec3, half: DVec3, material: u32) {
        const SQUARE: f64 = 0.35;
        let power = |x: f64, e: f64| x.abs().power(e).copysign(x);
        let at = |u: f64, v: f64| {
            let (around, up) = (u * std::f64::consts::TAU, (v - 0.5) * std::f64::consts::PI);
            let (sin_around, cos_around) = around.sine_cosine();
            let (sin_up, cos_up) = up.sine_cosine();
            let shape = |e: f64| {
                let ring = power(cos_up, e);
                dvec3(ring * power(cos_around, e), power(sin_up, e), ring * power(sin_around, e))
            };
            (middle + half * shape(SQUARE), (shape(2.0 - SQUARE) / half).normalize_or_zero())
        };
        self.sheet(FINE, at, material);
    }
}

/// A seat around the origin, looking down the z axis.
fn seat() -> WorldMesh {
    let mut mesh = WorldMesh::default();
    mesh.cushion(dvec3(0.0, 0.44, 0.0), dvec3(0.24, 0.06, 0.25), VELVET);
    mesh.cushion(dvec3(0.0, 0.78, 0.24), dvec3(0.25, 0.33, 0.05), VELVET);
    for side in [-1.0, 1.0] {
        mesh.cushion(dvec3(0.29 * side, 0.62, 0.02), dvec3(0.035, 0.025, 0.24), WOOD);
        mesh.cushion(dvec3(0.29 * side, 0.31, 0.08), dvec3(0.02, 0.31, 0.12), WOOD);
    }
    mesh
}

/// Placements of the seats, turned a little towards the stage; every second seat is mirrored.
fn places() -> Vec<DMat4> {
    let place = |i: usize| {
        let (row, seat) = (i / SEATS, i % SEATS);
        let along = (seat as f64 + 0.5) / SEATS as f64 - 0.5;
        // An aisle in the middle.
        let x = 10.0 + 16.4 * along + if along < 0.0 { -0.6 } else { 0.6 };
        let z = FIRST + STEP.y * (row as f64 + 0.45);
        let (sin, cos) = (0.5 * 0.12 * (x - 10.0) / 8.0).sine_cosine();
        let turn = DQuat::from_xyzw(0.0, sin, 0.0, cos);
        let mirror = if i.is_multiple_of(2) { DVec3::ONE } else { dvec3(-1.0, 1.0, 1.0) };
        DMat4::from_scale_rotation_translation(mirror, turn, dvec3(x, STEP.x * (row + 1) as f64, z))
    };
    (0..ROWS * SEATS).map(place).collect()
}

/// A curtain in folds at the back of the stage.
fn curtain(mesh: &mut WorldMesh) {
    let at = |u: f64, v: f64| {
        let (sin, cos) = (u * 40.0 * std::f64::consts::TAU).sine_cosine();
        let slope = 0.12 * 40.0 * std::f64::consts::TAU / HALL.x * cos;
        let position = dvec3(HALL.x * (1.0 - u), 1.0 + 7.0 * v, 0.4 + 0.12 * sin);
        (position, dvec3(slope, 0.0, 1.0).normalize())
    };
    mesh.sheet([640, 8], at, CURTAIN);
}
