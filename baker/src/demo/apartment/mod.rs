//! A furnished apartment of four rooms and a hall: windows to three sides for the sun, a lamp in each
//! room, a hedge outside. Open doors, slender frames and shades that hold a lamp. Metres; x points
//! east, z south, so that the sun rises at +x and sets at -x.

mod furniture;

use super::{block, camera, matt};
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};
use rebounce_shared::light::Light;

/// Width (x), height (y) and depth (z) within the outer walls.
const ROOM: DVec3 = dvec3(9.0, 2.7, 7.0);
/// Thickness of the outer walls.
const OUTER: f64 = 0.3;
/// Half the thickness of the walls between rooms.
const INNER: f64 = 0.06;

/// Materials, by index into [`MATERIALS`].
#[derive(Clone, Copy)]
enum Is {
    Floor,
    Wall,
    Accent,
    White,
    Wood,
    Oak,
    Tile,
    Steel,
    Dark,
    Sofa,
    Cushion,
    Rug,
    Linen,
    Blanket,
    Curtain,
    Leaf,
    Clay,
    Print,
    Brass,
    Grass,
    Hedge,
    YoungHedge,
    Stone,
}

/// Names and linear RGB albedos, in the order of [`Is`].
const MATERIALS: [(&str, [f32; 3]); 23] = [
    ("floor", [0.42, 0.27, 0.15]),
    ("wall", [0.74, 0.71, 0.66]),
    ("accent wall", [0.16, 0.3, 0.34]),
    ("white", [0.78, 0.77, 0.75]),
    ("walnut", [0.26, 0.14, 0.07]),
    ("oak", [0.52, 0.36, 0.2]),
    ("tile", [0.5, 0.5, 0.48]),
    ("steel", [0.45, 0.46, 0.48]),
    ("dark", [0.04, 0.04, 0.045]),
    ("sofa", [0.2, 0.28, 0.42]),
    ("cushion", [0.7, 0.36, 0.1]),
    ("rug", [0.56, 0.2, 0.14]),
    ("linen", [0.76, 0.74, 0.7]),
    ("blanket", [0.2, 0.36, 0.22]),
    ("curtain", [0.68, 0.6, 0.48]),
    ("leaf", [0.11, 0.2, 0.07]),
    ("clay", [0.5, 0.22, 0.12]),
    ("print", [0.62, 0.46, 0.14]),
    ("brass", [0.55, 0.4, 0.16]),
    ("grass", [0.22, 0.26, 0.12]),
    ("hedge", [0.15, 0.19, 0.1]),
    ("young hedge", [0.19, 0.23, 0.13]),
    ("stone", [0.48, 0.45, 0.4]),
];

pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    shell(&mut mesh);
    garden(&mut mesh);
    furniture::living_room(&mut mesh);
    furniture::kitchen(&mut mesh);
    furniture::bedroom(&mut mesh);
    furniture::study(&mut mesh);
    furniture::hall(&mut mesh);
    let look = |position: [f64; 3], target: [f64; 3]| camera(position, target, 62.0);
    let mut scene = Scene {
        name: "apartment".into(),
        materials: MATERIALS.iter().map(|(name, albedo)| matt(name, *albedo)).collect(),
        lights: lights(),
        light_names: LIGHTS.map(str::to_owned).into(),
        camera_names: ["Living room", "Kitchen", "Bedroom", "Study"].map(str::to_owned).into(),
        cameras: vec![
            look([5.2, 1.6, 3.1], [1.9, 0.95, 6.0]),
            look([3.7, 1.6, 6.6], [1.2, 1.0, 1.2]),
            look([8.2, 1.6, 3.0], [6.3, 0.85, 6.2]),
            look([6.4, 1.6, 2.4], [8.6, 0.9, 0.6]),
        ],
        ..Scene::default()
    };
    mesh.finish(&mut scene);
    scene
}

/// Names of [`lights`].
const LIGHTS: [&str; 6] = ["Sun", "Living room", "Dining table", "Kitchen", "Bedroom", "Study"];

/// The afternoon sun, then the lamps.
fn lights() -> Vec<Light> {
    let warm = [1.0, 0.8, 0.56];
    let spot = |position, direction, outer: f64, intensity| Light::Spot {
        position,
        direction,
        outer_cone_deg: outer,
        inner_cone_deg: Some(outer - 14.0),
        intensity,
        color: warm,
        radius: 0.0,
    };
    vec![
        Light::Directional {
            direction: [0.52, -0.62, -0.59],
            intensity: 40.0,
            color: [1.0, 0.93, 0.82],
            radius_deg: 0.0,
        },
        Light::Point { position: [0.5, 1.52, 6.5], intensity: 5.0, color: warm, radius: 0.0 },
        spot([4.3, 1.78, 5.7], [0.0, -1.0, 0.0], 58.0, 10.0),
        spot([1.9, 2.6, 1.1], [0.0, -1.0, -0.15], 56.0, 10.0),
        Light::Point { position: [5.98, 0.85, 4.62], intensity: 2.5, color: warm, radius: 0.0 },
        spot([8.55, 0.98, 0.62], [-0.5, -1.0, 0.3], 52.0, 5.0),
    ]
}

/// A hole in a wall: start and end along the wall, lower and upper height.
type Hole = [f64; 4];

/// Floor, ceiling, walls with doors and windows.
fn shell(mesh: &mut WorldMesh) {
    let low = DVec3::ZERO - DVec3::splat(OUTER);
    let high = ROOM + DVec3::splat(OUTER);
    block(mesh, low, dvec3(high.x, 0.0, high.z), Is::Floor as u32);
    block(mesh, dvec3(low.x, ROOM.y, low.z), high, Is::White as u32);
    let south: [Hole; 3] = [[0.9, 2.7, 0.25, 2.3], [3.2, 5.0, 0.25, 2.3], [6.5, 8.1, 0.8, 2.25]];
    let west: [Hole; 2] = [[0.9, 2.1, 1.2, 2.2], [4.0, 5.6, 0.8, 2.25]];
    let east: [Hole; 1] = [[0.7, 2.0, 0.9, 2.2]];
    wall(mesh, 0, [ROOM.z, high.z], [low.x, high.x], &south, Is::Wall);
    wall(mesh, 0, [low.z, 0.0], [low.x, high.x], &[], Is::Wall);
    wall(mesh, 2, [low.x, 0.0], [0.0, ROOM.z], &west, Is::Wall);
    wall(mesh, 2, [ROOM.x, high.x], [0.0, ROOM.z], &east, Is::Wall);
    for hole in &south {
        window(mesh, 0, ROOM.z + 0.12, hole);
    }
    for hole in &west {
        window(mesh, 2, -0.12, hole);
    }
    window(mesh, 2, ROOM.x + 0.12, &east[0]);
    let between = |mesh: &mut WorldMesh, axis, at: f64, ends, holes: &[Hole], is| {
        wall(mesh, axis, [at - INNER, at + INNER], ends, holes, is);
    };
    between(mesh, 0, 2.74, [0.0, ROOM.x], &[[0.7, 3.1, 0.0, 2.35], [4.5, 5.4, 0.0, 2.05]], Is::Wall);
    between(mesh, 2, 5.66, [2.74 + INNER, ROOM.z], &[[3.1, 4.0, 0.0, 2.05]], Is::Accent);
    between(mesh, 2, 4.06, [0.0, 2.74 - INNER], &[], Is::Wall);
    between(mesh, 2, 6.06, [0.0, 2.74 - INNER], &[[0.9, 1.8, 0.0, 2.05]], Is::Wall);
}

/// A wall along an axis (0: x, 2: z), from floor to ceiling, `thick` from one side to the other.
/// Holes in ascending order.
fn wall(mesh: &mut WorldMesh, axis: usize, thick: [f64; 2], ends: [f64; 2], holes: &[Hole], is: Is) {
    let mut piece = |along: [f64; 2], heights: [f64; 2]| {
        if along[1] > along[0] && heights[1] > heights[0] {
            slab(mesh, axis, along, heights, thick, is);
        }
    };
    let mut at = ends[0];
    for &[from, to, sill, head] in holes {
        piece([at, from], [0.0, ROOM.y]);
        piece([from, to], [0.0, sill]);
        piece([from, to], [head, ROOM.y]);
        at = to;
    }
    piece([at, ends[1]], [0.0, ROOM.y]);
}

/// A box whose length runs along x (0) or z (2).
fn slab(mesh: &mut WorldMesh, axis: usize, along: [f64; 2], heights: [f64; 2], thick: [f64; 2], is: Is) {
    let corner = |k: usize| match axis {
        0 => dvec3(along[k], heights[k], thick[k]),
        _ => dvec3(thick[k], heights[k], along[k]),
    };
    block(mesh, corner(0), corner(1), is as u32);
}

/// Frame and bars of a window, its middle plane at `at`.
fn window(mesh: &mut WorldMesh, axis: usize, at: f64, &[from, to, sill, head]: &Hole) {
    const BAR: f64 = 0.05;
    let thick = [at - 0.03, at + 0.03];
    let middle = 0.5 * (from + to);
    for x in [from, middle - 0.5 * BAR, to - BAR] {
        slab(mesh, axis, [x, x + BAR], [sill + BAR, head - BAR], thick, Is::White);
    }
    for y in [sill, head - BAR] {
        slab(mesh, axis, [from, to], [y, y + BAR], thick, Is::White);
    }
}

/// The view from the windows: grass, a terrace, and a hedge around, cut in uneven blocks.
fn garden(mesh: &mut WorldMesh) {
    const WIDTH: f64 = 0.9;
    let (low, high) = (dvec3(-6.6, -0.6, -4.5), dvec3(15.6, -0.32, 14.4));
    block(mesh, low, high, Is::Grass as u32);
    block(mesh, dvec3(0.2, high.y, ROOM.z + OUTER), dvec3(5.6, -0.1, 9.4), Is::Stone as u32);
    let mut hedge = |axis, [from, to]: [f64; 2], near: f64, far: f64, top: f64| {
        let count = ((to - from) / WIDTH).ceil();
        let at = |k: usize| from + (to - from) * k as f64 / count;
        for k in 0..count as usize {
            let uneven = 0.1 * ((k * 5) % 4) as f64;
            let thick = if near < far { [near + uneven, far] } else { [far, near - uneven] };
            let is = if k % 2 == 0 { Is::Hedge } else { Is::YoungHedge };
            slab(mesh, axis, [at(k), at(k + 1)], [high.y, top - 0.5 * uneven], thick, is);
        }
    };
    hedge(0, [low.x, high.x], high.z - 0.9, high.z, 3.7);
    hedge(0, [low.x, high.x], low.z + 0.9, low.z, 2.9);
    hedge(2, [low.z + 0.9, high.z - 0.9], low.x + 0.9, low.x, 2.9);
    hedge(2, [low.z + 0.9, high.z - 0.9], high.x - 0.9, high.x, 2.9);
}
