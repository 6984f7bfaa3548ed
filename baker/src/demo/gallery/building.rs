//! The building: walls, roofs, skylights, the bench and the track of the spots.

use super::super::block;
use super::super::walls::{Hole, slab, wall, window};
use super::works::SOUTH;
use super::{DARK, DARK_HEIGHT, Finish, HALL};
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};

/// Thickness of walls, roofs and the floor.
const THICK: f64 = 0.3;
/// The skylights: start and end of each along x, of all along z.
const SKYLIGHTS: [[f64; 2]; 3] = [[1.6, 3.6], [5.0, 7.0], [8.4, 10.4]];
const SKYLIGHTS_Z: [f64; 2] = [4.0, 5.8];
/// Top of the skylights' curbs.
const CURB: f64 = 4.95;
/// Windows of the north wall, below the roof.
const WINDOWS: [Hole; 4] =
    [[0.8, 3.2, 3.05, 4.05], [3.6, 6.0, 3.05, 4.05], [6.4, 8.8, 3.05, 4.05], [9.2, 11.6, 3.05, 4.05]];
/// The doorway to the dark room: along z, and its height.
const DOORWAY: Hole = [4.6, 6.8, 0.0, 2.7];
/// The track of the spots: its height and its place along z.
const TRACK: [f64; 2] = [4.25, 6.3];

/// Where the spot for a painting at `x` is: below its housing.
pub(super) fn spot_at(x: f64) -> DVec3 {
    dvec3(x, TRACK[0] - 0.26, TRACK[1])
}

pub(super) fn add(mesh: &mut WorldMesh) {
    let [[dark_from, dark_to], [dark_north, dark_south]] = DARK;
    let (wall_is, dark_is) = (Finish::Wall as u32, Finish::DarkWall as u32);
    let heights = [0.0, HALL.y];
    block(
        mesh,
        dvec3(-THICK, -THICK, -THICK),
        dvec3(dark_to + THICK, 0.0, HALL.z + THICK),
        Finish::Floor as u32,
    );
    wall(mesh, 0, [-THICK, 0.0], [-THICK, HALL.x], heights, &WINDOWS, wall_is);
    wall(mesh, 0, [HALL.z, HALL.z + THICK], [-THICK, HALL.x], heights, &[], wall_is);
    wall(mesh, 2, [-THICK, 0.0], [0.0, HALL.z], heights, &[], wall_is);
    wall(mesh, 2, [HALL.x, dark_from], [-THICK, HALL.z + THICK], heights, &[DOORWAY], wall_is);
    WINDOWS.iter().for_each(|hole| window(mesh, 0, -0.5 * THICK, hole, 3, Finish::Frame as u32));
    // The dark room.
    let dark = [0.0, DARK_HEIGHT];
    wall(mesh, 0, [dark_north - THICK, dark_north], [dark_from, dark_to + THICK], dark, &[], dark_is);
    wall(mesh, 0, [dark_south, dark_south + THICK], [dark_from, dark_to + THICK], dark, &[], dark_is);
    wall(mesh, 2, [dark_to, dark_to + THICK], [dark_north, dark_south], dark, &[], dark_is);
    let low = dvec3(dark_from, DARK_HEIGHT, dark_north - THICK);
    block(mesh, low, dvec3(dark_to + THICK, DARK_HEIGHT + THICK, dark_south + THICK), dark_is);
    lining(mesh);
    roof(mesh);
    track(mesh);
    bench(mesh);
}

/// Dark boards on the dark room's side of the hall's wall.
fn lining(mesh: &mut WorldMesh) {
    let [[from, _], [north, south]] = DARK;
    let is = Finish::DarkWall as u32;
    wall(mesh, 2, [from, from + 0.02], [north, south], [0.0, DARK_HEIGHT], &[DOORWAY], is);
}

/// The hall's roof, with skylights: curbs, a frame and bars.
fn roof(mesh: &mut WorldMesh) {
    const LIP: f64 = 0.08;
    const BAR: f64 = 0.05;
    let [from_z, to_z] = SKYLIGHTS_Z;
    let (low, high) = (-THICK, dvec3(HALL.x + THICK, HALL.y + THICK, HALL.z + THICK));
    let is = Finish::Wall as u32;
    let mut piece = |x: [f64; 2], z: [f64; 2]| {
        block(mesh, dvec3(x[0], HALL.y, z[0]), dvec3(x[1], high.y, z[1]), is);
    };
    piece([low, high.x], [low, from_z]);
    piece([low, high.x], [to_z, high.z]);
    let mut at = low;
    for [from, to] in SKYLIGHTS {
        piece([at, from], SKYLIGHTS_Z);
        at = to;
    }
    piece([at, high.x], SKYLIGHTS_Z);
    for [from, to] in SKYLIGHTS {
        let curb = [high.y, CURB];
        for z in [[from_z - LIP, from_z], [to_z, to_z + LIP]] {
            slab(mesh, 0, [from - LIP, to + LIP], curb, z, is);
        }
        for x in [[from - LIP, from], [to, to + LIP]] {
            slab(mesh, 2, SKYLIGHTS_Z, curb, x, is);
        }
        let glazing = [CURB - BAR, CURB];
        for k in 0..=3 {
            let x = from + (to - from - BAR) * f64::from(k) / 3.0;
            slab(mesh, 2, SKYLIGHTS_Z, glazing, [x, x + BAR], Finish::Frame as u32);
        }
    }
}

/// A track on two rods below the ceiling, with a housing for each spot.
fn track(mesh: &mut WorldMesh) {
    let [y, z] = TRACK;
    let is = Finish::Black as u32;
    block(mesh, dvec3(0.8, y, z - 0.02), dvec3(11.2, y + 0.035, z + 0.02), is);
    for x in [1.2, 4.4, 7.6, 10.8] {
        block(mesh, dvec3(x, y + 0.035, z - 0.008), dvec3(x + 0.016, HALL.y, z + 0.008), is);
    }
    for work in SOUTH {
        mesh.prism(dvec3(work.x, y - 0.06, z), 0.015, 0.06, 8, is);
        mesh.prism(dvec3(work.x, y - 0.24, z), 0.05, 0.18, 12, is);
    }
}

/// A bench of oak on two legs of steel.
fn bench(mesh: &mut WorldMesh) {
    const LOW: DVec3 = dvec3(4.7, 0.0, 5.0);
    const SIZE: DVec3 = dvec3(1.9, 0.45, 0.5);
    const TOP: f64 = 0.07;
    block(mesh, LOW + dvec3(0.0, SIZE.y - TOP, 0.0), LOW + SIZE, Finish::Oak as u32);
    for x in [0.22, SIZE.x - 0.28] {
        let leg = LOW + dvec3(x, 0.0, 0.04);
        block(mesh, leg, leg + dvec3(0.06, SIZE.y - TOP, SIZE.z - 0.08), Finish::Steel as u32);
    }
}
