//! A court in the sun with an arcade along one side, behind pillars and hanging curtains: a dim place beside a lit
//! place. The sun stands on the arcade's side, so that no sunlight falls between the pillars. Metres.

use super::{block, camera, matt};
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};
use rebounce_shared::light::Light;
use rebounce_shared::rbn::meta::Material;

/// Width (x) and depth (z) of the court, and height of its walls (y).
const COURT: DVec3 = dvec3(6.5, 9.0, 11.0);
/// Width (−x) and height of the arcade, as long as the court.
const WIDTH: f64 = 3.2;
const HEIGHT: f64 = 3.6;
/// Distance between the pillars' centres, and width of a pillar.
const BAY: f64 = 2.2;
const PILLAR: f64 = 0.5;
/// Height of the curtains' lower ends above the floor.
const HEM: f64 = 0.5;
/// Folds of a curtain.
const FOLDS: usize = 6;

const FLOOR: u32 = 0;
const WALL: u32 = 1;
const STONE: u32 = 2;
const CURTAIN: u32 = 3;
const WOOD: u32 = 4;
const CLAY: u32 = 5;

/// The first camera looks along the arcade, the second one across the court.
pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    court(&mut mesh);
    arcade(&mut mesh);
    furniture(&mut mesh);
    let look = |position: DVec3, target: DVec3| camera(position, target, 60.0);
    let curtain = Material { double_sided: true, ..matt("curtain", [0.45, 0.08, 0.06]) };
    let mut scene = Scene {
        name: "arcade".into(),
        materials: vec![
            matt("floor", [0.42, 0.36, 0.28]),
            matt("wall", [0.68, 0.6, 0.48]),
            matt("stone", [0.56, 0.52, 0.46]),
            curtain,
            matt("wood", [0.3, 0.18, 0.09]),
            matt("clay", [0.5, 0.24, 0.13]),
        ],
        lights: vec![Light::Directional {
            direction: [0.5, -1.0, 0.12],
            intensity: 40.0,
            color: [1.0, 0.95, 0.86],
            radius_deg: 0.0,
        }],
        cameras: vec![
            look(dvec3(-1.5, 1.6, 10.4), dvec3(-1.7, 1.2, 2.0)),
            look(dvec3(5.8, 2.2, 10.2), dvec3(0.0, 2.0, 3.0)),
        ],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}

/// Floor and walls, seen from within; no roof.
fn court(mesh: &mut WorldMesh) {
    let DVec3 { x, y, z } = COURT;
    mesh.quad([dvec3(0.0, 0.0, 0.0), dvec3(0.0, 0.0, z), dvec3(x, 0.0, z), dvec3(x, 0.0, 0.0)], FLOOR);
    mesh.quad([dvec3(0.0, 0.0, 0.0), dvec3(x, 0.0, 0.0), dvec3(x, y, 0.0), dvec3(0.0, y, 0.0)], WALL);
    mesh.quad([dvec3(x, 0.0, z), dvec3(0.0, 0.0, z), dvec3(0.0, y, z), dvec3(x, y, z)], WALL);
    mesh.quad([dvec3(x, 0.0, 0.0), dvec3(x, 0.0, z), dvec3(x, y, z), dvec3(x, y, 0.0)], WALL);
    // The wall above the arcade.
    block(mesh, dvec3(-PILLAR, HEIGHT - 0.4, 0.0), dvec3(0.0, y, z), WALL);
}

/// The arcade's room, its pillars and the curtains between them.
fn arcade(mesh: &mut WorldMesh) {
    let (z, left) = (COURT.z, -WIDTH);
    let floor = [dvec3(left, 0.0, 0.0), dvec3(left, 0.0, z), dvec3(0.0, 0.0, z), dvec3(0.0, 0.0, 0.0)];
    let ceiling = floor.map(|p| dvec3(p.x.min(-PILLAR), HEIGHT, p.z));
    mesh.quad(floor, FLOOR);
    mesh.quad([ceiling[3], ceiling[2], ceiling[1], ceiling[0]], WALL);
    mesh.quad([floor[1], floor[0], ceiling[0], ceiling[1]], WALL);
    let end =
        |z: f64| [dvec3(left, 0.0, z), dvec3(0.0, 0.0, z), dvec3(0.0, HEIGHT, z), dvec3(left, HEIGHT, z)];
    let [a, b, c, d] = end(z);
    mesh.quad(end(0.0), WALL);
    mesh.quad([b, a, d, c], WALL);
    for k in 0..=5 {
        let from = (BAY * k as f64 - 0.5 * PILLAR).max(0.0);
        let to = (BAY * k as f64 + 0.5 * PILLAR).min(z);
        block(mesh, dvec3(-PILLAR, 0.0, from), dvec3(0.0, HEIGHT - 0.4, to), STONE);
    }
    for k in 0..5 {
        // The second curtain is drawn aside.
        let share = if k == 1 { 0.7 } else { 1.0 };
        let from = BAY * k as f64 + 0.5 * PILLAR;
        curtain(mesh, from, from + share * (BAY - PILLAR));
    }
}

/// A curtain in folds from one z to another.
fn curtain(mesh: &mut WorldMesh, from: f64, to: f64) {
    let at = |k: usize, y: f64| {
        let x = -0.5 * PILLAR + if k.is_multiple_of(2) { 0.07 } else { -0.07 };
        dvec3(x, y, from + (to - from) * k as f64 / (2 * FOLDS) as f64)
    };
    for k in 0..2 * FOLDS {
        let top = HEIGHT - 0.4;
        mesh.quad([at(k, HEM), at(k, top), at(k + 1, top), at(k + 1, HEM)], CURTAIN);
    }
}

/// Benches along the arcade's wall and pots between them.
fn furniture(mesh: &mut WorldMesh) {
    for k in 0..3 {
        let z = 1.6 + 3.4 * k as f64;
        let seat = dvec3(-WIDTH + 0.1, 0.42, z);
        block(mesh, seat, seat + dvec3(0.45, 0.06, 1.5), WOOD);
        for (x, along) in [(0.04, 0.1), (0.35, 0.1), (0.04, 1.34), (0.35, 1.34)] {
            let foot = dvec3(seat.x + x, 0.0, z + along);
            block(mesh, foot, foot + dvec3(0.06, 0.42, 0.06), WOOD);
        }
        let pot = dvec3(-WIDTH + 0.2, 0.0, z + 2.0);
        block(mesh, pot, pot + dvec3(0.5, 0.6, 0.5), CLAY);
    }
    block(mesh, dvec3(2.2, 0.0, 4.4), dvec3(4.2, 0.7, 6.4), STONE);
}
