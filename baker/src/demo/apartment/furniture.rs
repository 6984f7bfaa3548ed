//! Furniture of the rooms: boxes and prisms.

use super::{Is, ROOM, WorldMesh, block};
use glam::{DVec3, dvec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::TAU;

/// Corners of round objects.
const SIDES: usize = 12;

/// A box from its least x, y, z and its size.
fn put(mesh: &mut WorldMesh, low: [f64; 3], size: [f64; 3], is: Is) {
    let low = DVec3::from(low);
    block(mesh, low, low + DVec3::from(size), is as u32);
}

/// An upright prism with a regular base; `foot` is the centre of the base.
fn column(mesh: &mut WorldMesh, foot: [f64; 3], radius: f64, height: f64, is: Is) {
    mesh.prism(foot.into(), radius, height, SIDES, is as u32);
}

/// A conical lamp shade, open above and below: cloth that shines outwards, linen within. `foot`: the middle of the lower
/// edge.
fn cloth_shade(mesh: &mut WorldMesh, foot: [f64; 3], [lower, upper]: [f64; 2], height: f64, is: Is) {
    const CLOTH: f64 = 0.006;
    let rim = |k: usize, radius: f64, y: f64| {
        let (sin, cos) = (TAU * k as f64 / SIDES as f64).sine_cosine();
        DVec3::from(foot) + dvec3(radius * cos, y, -radius * sin)
    };
    let mut band = |[r, y]: [f64; 2], [next_r, next_y]: [f64; 2], is: Is| {
        for k in 0..SIDES {
            let corners =
                [rim(k, r, y), rim(k + 1, r, y), rim(k + 1, next_r, next_y), rim(k, next_r, next_y)];
            mesh.quad(corners, is as u32);
        }
    };
    let [outside, inside] = [[lower, upper], [lower - CLOTH, upper - CLOTH]];
    band([outside[0], 0.0], [outside[1], height], is);
    band([outside[1], height], [inside[1], height], Is::Linen);
    band([inside[1], height], [inside[0], 0.0], Is::Linen);
    band([inside[0], 0.0], [outside[0], 0.0], Is::Linen);
    // Spokes to the pole.
    const THICK: f64 = 0.006;
    let [x, y, z] = foot;
    put(mesh, [x - inside[0], y, z - 0.5 * THICK], [2.0 * inside[0], THICK, THICK], Is::Brass);
    put(mesh, [x - 0.5 * THICK, y, z - inside[0]], [THICK, THICK, 2.0 * inside[0]], Is::Brass);
}

/// Four boards around a lamp, open above and below. `foot`: the middle of the lower edge.
fn shade(mesh: &mut WorldMesh, foot: [f64; 3], half: f64, height: f64, is: Is) {
    const BOARD: f64 = 0.01;
    let [x, y, z] = foot;
    for side in [-half, half - BOARD] {
        put(mesh, [x - half, y, z + side], [2.0 * half, height, BOARD], is);
        put(mesh, [x + side, y, z - half + BOARD], [BOARD, height, 2.0 * (half - BOARD)], is);
    }
}

/// A top on four legs. `low`: the least corner on the floor; `size`: with legs.
fn table(mesh: &mut WorldMesh, low: [f64; 3], size: [f64; 3], top: f64, leg: f64, is: Is) {
    let [x, y, z] = low;
    put(mesh, [x, y + size[1] - top, z], [size[0], top, size[2]], is);
    for at_x in [x + 0.03, x + size[0] - leg - 0.03] {
        for at_z in [z + 0.03, z + size[2] - leg - 0.03] {
            put(mesh, [at_x, y, at_z], [leg, size[1] - top, leg], is);
        }
    }
}

/// A chair of 42 cm, with the back at the greater (`side` = 1) or lesser (-1) z.
fn chair(mesh: &mut WorldMesh, x: f64, z: f64, side: f64, is: Is) {
    table(mesh, [x, 0.0, z], [0.42, 0.46, 0.42], 0.04, 0.035, is);
    let back = if side > 0.0 { z + 0.385 } else { z };
    put(mesh, [x, 0.46, back], [0.42, 0.42, 0.035], is);
}

/// Boards of a shelf against the wall at `z`, open to greater z, and books on them.
fn shelf(mesh: &mut WorldMesh, [left, right]: [f64; 2], z: f64, rows: usize, is: Is) {
    const DEPTH: f64 = 0.28;
    const STEP: f64 = 0.36;
    const BOARD: f64 = 0.025;
    let height = rows as f64 * STEP;
    for x in [left, right - BOARD] {
        put(mesh, [x, 0.0, z], [BOARD, height + BOARD, DEPTH], is);
    }
    let books = [Is::Rug, Is::Sofa, Is::Linen, Is::Blanket, Is::Print, Is::Accent, Is::Clay];
    let mut turn = 0;
    for row in 0..=rows {
        let y = row as f64 * STEP;
        put(mesh, [left + BOARD, y, z], [right - left - 2.0 * BOARD, BOARD, DEPTH], is);
        let mut x = left + BOARD + 0.01;
        while row < rows && x < right - 0.16 {
            // Widths and heights from the digits of a few primes: no two neighbours alike.
            turn += 1;
            let width = 0.025 + 0.006 * ((turn * 7) % 5) as f64;
            let tall = 0.2 + 0.015 * ((turn * 11) % 7) as f64;
            put(mesh, [x, y + BOARD, z + 0.01], [width, tall, 0.2], books[(turn * 5) % books.len()]);
            x += width + if turn % 6 == 0 { 0.14 } else { 0.003 };
        }
    }
}

/// A pot with leaves on stems.
fn plant(mesh: &mut WorldMesh, [x, y, z]: [f64; 3], height: f64) {
    column(mesh, [x, y, z], 0.14, 0.28, Is::Clay);
    for k in 0..9 {
        let (sin, cos) = (2.4 * k as f64).sine_cosine();
        let out = 0.07 + 0.018 * k as f64;
        let top = 0.36 + (height - 0.36) * (k + 1) as f64 / 9.0;
        let stem = [x + 0.05 * cos, y + 0.28, z + 0.05 * sin];
        put(mesh, stem, [0.012, top - 0.28, 0.012], Is::Leaf);
        let leaf = [x + out * cos - 0.07, y + top, z + out * sin - 0.07];
        put(mesh, leaf, [0.16, 0.012, 0.16], Is::Leaf);
    }
}

/// A framed picture before a wall: `low` and `size` of the frame, thin along `axis`, seen from the greater (`side` = 1)
/// or lesser (-1) end of `axis`.
fn picture(mesh: &mut WorldMesh, low: [f64; 3], size: [f64; 3], axis: usize, side: f64, is: Is) {
    put(mesh, low, size, Is::Dark);
    let (mut low, mut size) = (low, size);
    for k in 0..3 {
        if k == axis {
            low[k] += if side > 0.0 { size[k] } else { -0.004 };
            size[k] = 0.004;
        } else {
            low[k] += 0.04;
            size[k] -= 0.08;
        }
    }
    put(mesh, low, size, is);
}

/// Both halves of a curtain beside the window from x = `from` to `to`.
fn curtains(mesh: &mut WorldMesh, from: f64, to: f64) {
    for x in [from - 0.22, to + 0.02] {
        for fold in 0..4 {
            let z = ROOM.z - 0.09 - 0.03 * (fold % 2) as f64;
            put(mesh, [x + 0.05 * fold as f64, 0.04, z], [0.05, 2.4, 0.025], Is::Curtain);
        }
    }
    put(mesh, [from - 0.3, 2.44, ROOM.z - 0.12], [to - from + 0.6, 0.03, 0.03], Is::Brass);
}

/// A television on the sideboard, its picture in bands: a sunset over a lake.
fn television(mesh: &mut WorldMesh) {
    const LOW: DVec3 = dvec3(3.48, 0.6, 2.85);
    const SIZE: DVec3 = dvec3(0.92, 0.54, 0.03);
    const RIM: f64 = 0.015;
    /// Upper edges of the bands, as shares of the picture's height, from below.
    const BANDS: [(f64, Is); 4] =
        [(0.3, Is::ScreenLake), (0.45, Is::ScreenHills), (0.62, Is::ScreenSun), (1.0, Is::ScreenSky)];
    put(mesh, LOW.to_array(), SIZE.to_array(), Is::Dark);
    put(mesh, [3.86, 0.54, 2.85], [0.16, 0.06, 0.03], Is::Dark);
    put(mesh, [3.74, 0.54, 2.83], [0.4, 0.01, 0.2], Is::Dark);
    let (height, mut from) = (SIZE.y - 2.0 * RIM, 0.0);
    for (to, is) in BANDS {
        // Faces alone, as what lies behind a picture lights nothing.
        let corner = |x: f64, share: f64| LOW + dvec3(x, RIM + height * share, SIZE.z + 0.002);
        let [left, right] = [RIM, SIZE.x - RIM];
        mesh.quad([corner(left, from), corner(right, from), corner(right, to), corner(left, to)], is as u32);
        from = to;
    }
}

pub(super) fn living_room(mesh: &mut WorldMesh) {
    put(mesh, [0.9, 0.0, 3.9], [2.3, 0.012, 2.0], Is::Rug);
    // The sofa stands with its back to the west window.
    put(mesh, [0.12, 0.1, 3.75], [0.86, 0.32, 2.1], Is::Sofa);
    put(mesh, [0.12, 0.42, 3.75], [0.22, 0.36, 2.1], Is::Sofa);
    for z in [3.6, 5.85] {
        put(mesh, [0.12, 0.1, z], [0.86, 0.5, 0.15], Is::Sofa);
    }
    for z in [3.82, 5.4] {
        put(mesh, [0.36, 0.42, z], [0.14, 0.36, 0.4], Is::Cushion);
    }
    put(mesh, [0.36, 0.42, 4.6], [0.13, 0.34, 0.38], Is::Linen);
    table(mesh, [1.55, 0.012, 4.3], [0.65, 0.4, 1.1], 0.04, 0.04, Is::Wood);
    put(mesh, [1.7, 0.412, 4.5], [0.22, 0.03, 0.3], Is::Print);
    put(mesh, [1.72, 0.442, 4.53], [0.2, 0.025, 0.26], Is::Linen);
    column(mesh, [1.95, 0.412, 5.15], 0.07, 0.16, Is::White);
    // The lamp: foot, pole and an open shade.
    column(mesh, [0.5, 0.0, 6.5], 0.15, 0.03, Is::Brass);
    column(mesh, [0.5, 0.03, 6.5], 0.015, 1.34, Is::Brass);
    cloth_shade(mesh, [0.5, 1.36, 6.5], [0.23, 0.17], 0.32, Is::Shade);
    // Dining table under the pendant.
    table(mesh, [3.65, 0.0, 5.3], [1.3, 0.75, 0.8], 0.035, 0.06, Is::Oak);
    for x in [3.8, 4.4] {
        chair(mesh, x, 6.05, 1.0, Is::Wood);
        chair(mesh, x, 4.95, -1.0, Is::Wood);
    }
    column(mesh, [4.3, 0.75, 5.7], 0.14, 0.06, Is::Clay);
    for (x, z) in [(4.25, 5.66), (4.35, 5.72), (4.28, 5.76)] {
        put(mesh, [x - 0.035, 0.81, z - 0.035], [0.07, 0.06, 0.07], Is::Cushion);
    }
    column(mesh, [4.3, 2.0, 5.7], 0.006, 0.7, Is::Dark);
    column(mesh, [4.3, 1.96, 5.7], 0.2, 0.04, Is::Brass);
    shade(mesh, [4.3, 1.8, 5.7], 0.17, 0.16, Is::Brass);
    // A sideboard with a television, a picture, a plant.
    put(mesh, [3.3, 0.12, 2.82], [1.1, 0.42, 0.4], Is::Oak);
    put(mesh, [3.35, 0.0, 2.86], [1.0, 0.12, 0.32], Is::Dark);
    television(mesh);
    picture(mesh, [5.57, 1.25, 4.7], [0.028, 0.8, 1.1], 0, -1.0, Is::Print);
    plant(mesh, [5.25, 0.0, 6.65], 1.25);
    plant(mesh, [0.35, 0.0, 3.2], 0.95);
    curtains(mesh, 0.9, 2.7);
    curtains(mesh, 3.2, 5.0);
}

pub(super) fn kitchen(mesh: &mut WorldMesh) {
    put(mesh, [0.0, 0.0, 0.0], [4.0, 0.008, 2.68], Is::Tile);
    put(mesh, [0.0, 0.1, 0.0], [3.3, 0.78, 0.6], Is::White);
    put(mesh, [0.0, 0.0, 0.0], [3.3, 0.1, 0.54], Is::Dark);
    put(mesh, [0.0, 0.88, 0.0], [3.3, 0.04, 0.63], Is::Oak);
    for x in [0.02, 0.68, 1.34, 2.0, 2.66] {
        put(mesh, [x, 0.12, 0.6], [0.62, 0.74, 0.016], Is::White);
        put(mesh, [x + 0.21, 0.78, 0.616], [0.2, 0.015, 0.02], Is::Brass);
    }
    for x in [0.0, 0.6, 2.1, 2.7] {
        put(mesh, [x + 0.01, 1.5, 0.0], [0.58, 0.7, 0.34], Is::Oak);
    }
    put(mesh, [1.3, 0.92, 0.12], [0.58, 0.006, 0.42], Is::Dark);
    put(mesh, [1.28, 1.62, 0.0], [0.62, 0.12, 0.42], Is::Steel);
    put(mesh, [1.46, 1.74, 0.0], [0.26, 0.96, 0.24], Is::Steel);
    put(mesh, [3.36, 0.0, 0.0], [0.62, 1.9, 0.64], Is::Steel);
    put(mesh, [3.36, 0.7, 0.64], [0.62, 0.01, 0.01], Is::Dark);
    column(mesh, [1.45, 0.926, 0.3], 0.1, 0.12, Is::Steel);
    column(mesh, [2.5, 0.92, 0.25], 0.06, 0.2, Is::Clay);
    column(mesh, [2.68, 0.92, 0.2], 0.05, 0.15, Is::White);
    put(mesh, [0.3, 0.92, 0.15], [0.3, 0.28, 0.03], Is::Wood);
}

pub(super) fn bedroom(mesh: &mut WorldMesh) {
    put(mesh, [6.0, 0.0, 4.6], [2.2, 0.012, 2.0], Is::Linen);
    // The bed's head is at the accent wall.
    put(mesh, [5.74, 0.12, 4.9], [2.1, 0.2, 1.6], Is::Wood);
    put(mesh, [5.74, 0.0, 5.0], [1.9, 0.12, 1.4], Is::Dark);
    put(mesh, [5.72, 0.0, 4.85], [0.06, 1.0, 1.7], Is::Wood);
    put(mesh, [5.8, 0.32, 4.95], [2.0, 0.2, 1.5], Is::Linen);
    put(mesh, [6.55, 0.5, 4.92], [1.28, 0.05, 1.56], Is::Blanket);
    for z in [5.05, 5.75] {
        put(mesh, [5.86, 0.52, z], [0.42, 0.12, 0.6], Is::White);
    }
    for z in [4.4, 6.56] {
        put(mesh, [5.74, 0.0, z], [0.42, 0.5, 0.4], Is::Oak);
    }
    column(mesh, [5.98, 0.5, 4.62], 0.07, 0.02, Is::Brass);
    column(mesh, [5.98, 0.52, 4.62], 0.02, 0.225, Is::Brass);
    cloth_shade(mesh, [5.98, 0.74, 4.62], [0.14, 0.1], 0.2, Is::BedsideShade);
    put(mesh, [5.85, 0.5, 6.66], [0.2, 0.03, 0.14], Is::Rug);
    // Wardrobe along the east wall.
    put(mesh, [8.4, 0.0, 4.6], [0.6, 2.2, 1.8], Is::White);
    for z in [4.62, 5.22, 5.82] {
        put(mesh, [8.384, 0.05, z], [0.016, 2.1, 0.56], Is::Oak);
    }
    picture(mesh, [6.7, 1.3, 2.8], [1.2, 0.7, 0.028], 2, 1.0, Is::Blanket);
    plant(mesh, [8.6, 0.0, 6.7], 1.1);
    curtains(mesh, 6.5, 8.1);
}

pub(super) fn study(mesh: &mut WorldMesh) {
    put(mesh, [6.5, 0.0, 0.9], [1.7, 0.012, 1.3], Is::Sofa);
    table(mesh, [7.2, 0.0, 0.1], [1.7, 0.74, 0.72], 0.035, 0.05, Is::Oak);
    put(mesh, [7.6, 0.86, 0.2], [0.62, 0.36, 0.025], Is::Dark);
    put(mesh, [7.87, 0.74, 0.18], [0.08, 0.12, 0.05], Is::Dark);
    put(mesh, [7.7, 0.74, 0.45], [0.42, 0.018, 0.14], Is::White);
    put(mesh, [7.3, 0.74, 0.3], [0.2, 0.05, 0.28], Is::Rug);
    chair(mesh, 7.75, 0.95, 1.0, Is::Wood);
    // The desk lamp: foot, arm, and a hood above the light.
    column(mesh, [8.7, 0.74, 0.45], 0.08, 0.02, Is::Brass);
    column(mesh, [8.7, 0.76, 0.45], 0.012, 0.32, Is::Brass);
    put(mesh, [8.46, 1.02, 0.53], [0.26, 0.05, 0.18], Is::Brass);
    put(mesh, [8.4, 1.24, 0.005], [0.5, 0.02, 0.2], Is::Oak);
    shelf(mesh, [6.2, 7.0], 0.0, 6, Is::Wood);
    picture(mesh, [7.4, 1.55, 0.0], [0.8, 0.6, 0.028], 2, 1.0, Is::Cushion);
    plant(mesh, [8.65, 0.0, 2.35], 1.2);
}

pub(super) fn hall(mesh: &mut WorldMesh) {
    put(mesh, [4.5, 0.0, 0.6], [1.0, 0.012, 1.7], Is::Print);
    put(mesh, [4.12, 0.0, 0.3], [0.34, 0.85, 1.2], Is::Wood);
    column(mesh, [4.3, 0.85, 0.6], 0.08, 0.24, Is::Clay);
    picture(mesh, [4.12, 1.2, 0.5], [0.028, 0.7, 0.7], 0, 1.0, Is::Linen);
    for k in 0..4 {
        put(mesh, [4.7 + 0.28 * k as f64, 1.7, 0.0], [0.03, 0.03, 0.08], Is::Brass);
    }
    put(mesh, [5.2, 0.95, 0.03], [0.3, 0.72, 0.09], Is::Sofa);
}
