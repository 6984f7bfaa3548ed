//! The view from the windows: grass, a terrace, a hedge around that hides the horizon, trees before the sky.

use super::super::walls::slab;
use super::{Is, OUTER, ROOM, block};
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::{PI, TAU};

/// Least and greatest corner of the lawn.
const LOW: DVec3 = dvec3(-6.6, -0.6, -4.5);
const HIGH: DVec3 = dvec3(15.6, -0.32, 14.4);
/// Least length of a piece of hedge, and its thickness.
const WIDTH: f64 = 0.9;
/// Height of the hedge's top over the rooms' floor: about that of eyes.
const TOP: f64 = 1.75;

pub(super) fn add(mesh: &mut WorldMesh) {
    block(mesh, LOW, HIGH, Is::Grass as u32);
    block(mesh, dvec3(0.2, HIGH.y, ROOM.z + OUTER), dvec3(5.6, -0.1, 9.4), Is::Stone as u32);
    let [from, to] = [LOW.z + WIDTH, HIGH.z - WIDTH];
    hedge(mesh, 0, [LOW.x, HIGH.x], to, HIGH.z);
    hedge(mesh, 0, [LOW.x, HIGH.x], from, LOW.z);
    hedge(mesh, 2, [from, to], LOW.x + WIDTH, LOW.x);
    hedge(mesh, 2, [from, to], HIGH.x - WIDTH, HIGH.x);
    for (x, z, height) in
        [(-3.6, 11.6, 5.2), (2.4, 12.3, 4.4), (9.6, 11.4, 5.6), (-4.2, 3.4, 4.8), (13.0, 2.6, 5.0)]
    {
        tree(mesh, x, z, height);
    }
}

/// A hedge along an axis (0: x, 2: z), cut in uneven blocks on its near side.
fn hedge(mesh: &mut WorldMesh, axis: usize, [from, to]: [f64; 2], near: f64, far: f64) {
    let count = ((to - from) / WIDTH).ceil();
    let at = |k: usize| from + (to - from) * k as f64 / count;
    for k in 0..count as usize {
        let uneven = 0.1 * ((k * 5) % 4) as f64;
        let thick = if near < far { [near + uneven, far] } else { [far, near - uneven] };
        let is = if k % 2 == 0 { Is::Hedge } else { Is::YoungHedge };
        slab(mesh, axis, [at(k), at(k + 1)], [HIGH.y, TOP - 0.5 * uneven], thick, is as u32);
    }
}

/// A tree cut round: a trunk, and an egg of a crown. `height`: from the lawn to the top.
fn tree(mesh: &mut WorldMesh, x: f64, z: f64, height: f64) {
    const SIDES: usize = 12;
    const RINGS: usize = 6;
    const TRUNK: f64 = 0.09;
    let crown = 0.6 * height;
    let foot = dvec3(x, HIGH.y, z);
    mesh.prism(foot, TRUNK, height - 0.9 * crown, SIDES, Is::Bark as u32);
    // From the trunk to the top, nearly a point.
    let rim = |ring: usize, side: usize| {
        let polar = PI * (0.02 + 0.97 * ring as f64 / RINGS as f64);
        let (sin, cos) = (TAU * side as f64 / SIDES as f64).sine_cosine();
        let radius = 0.36 * crown * polar.sine();
        let y = height - crown * (0.5 + 0.5 * polar.cosine());
        foot + dvec3(radius * cos, y, -radius * sin)
    };
    for (ring, side) in (0..RINGS).flat_map(|ring| (0..SIDES).map(move |side| (ring, side))) {
        let is = if (ring + side) % 3 == 0 { Is::Hedge } else { Is::YoungHedge };
        let lower = [rim(ring, side), rim(ring, side + 1)];
        mesh.quad([lower[0], lower[1], rim(ring + 1, side + 1), rim(ring + 1, side)], is as u32);
    }
}
