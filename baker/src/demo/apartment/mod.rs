//! A furnished apartment of four rooms and a hall: windows to three sides for sun and sky, a lamp in each
//! room, shades and a television that shine, a garden outside. Open doors, slender frames and shades that
//! hold a lamp. Metres; x points east, z south, so that the sun rises at +x and sets at -x.

mod furniture;
mod garden;

use super::sky::add_clear_sky;
use super::walls::{Hole, wall, window};
use super::{block, camera, matt, shining};
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
    Bark,
    Shade,
    BedsideShade,
    /// The television's picture, from the top.
    ScreenSky,
    ScreenSun,
    ScreenHills,
    ScreenLake,
}

/// Names and linear RGB albedos, in the order of [`Is`].
const MATERIALS: [(&str, [f32; 3]); 24] = [
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
    ("bark", [0.18, 0.13, 0.09]),
];

/// Shining materials, which follow in the order of [`Is`]: name, light group, albedo, radiance in nits.
const SHINING: [(&str, &str, [f32; 3], [f32; 3]); 6] = [
    ("lamp shade", "Lamp shade", [0.7, 0.64, 0.54], [5.0, 3.5, 1.9]),
    ("bedside shade", "Bedside shade", [0.7, 0.64, 0.54], [4.0, 2.7, 1.4]),
    ("screen: sky", "Television", SCREEN, [1.0, 1.9, 3.4]),
    ("screen: sunset", "Television", SCREEN, [4.2, 2.2, 0.9]),
    ("screen: hills", "Television", SCREEN, [0.25, 0.4, 0.5]),
    ("screen: lake", "Television", SCREEN, [0.9, 1.3, 2.2]),
];
/// Albedo of a screen.
const SCREEN: [f32; 3] = [0.04; 3];

/// Direction of the afternoon sun's light.
const SUN: [f64; 3] = [0.52, -0.62, -0.59];
/// Factor of the sky's radiance: as in a photograph, sun and sky are dimmed beside the lamps, both alike.
const SKY: f64 = 0.4;

pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    shell(&mut mesh);
    garden::add(&mut mesh);
    furniture::living_room(&mut mesh);
    furniture::kitchen(&mut mesh);
    furniture::bedroom(&mut mesh);
    furniture::study(&mut mesh);
    furniture::hall(&mut mesh);
    let plain = MATERIALS.iter().map(|(name, albedo)| (matt(name, *albedo), None));
    let bright = SHINING.iter().map(|(name, group, albedo, emission)| {
        (shining(name, *albedo, *emission), Some((*group).to_owned()))
    });
    let (materials, light_groups) = plain.chain(bright).unzip();
    let look = |position: [f64; 3], target: [f64; 3]| camera(position, target, 62.0);
    let mut scene = Scene {
        name: "apartment".into(),
        materials,
        light_groups,
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
    add_clear_sky(&mut scene, SUN, SKY);
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
        Light::Directional { direction: SUN, intensity: 40.0, color: [1.0, 0.93, 0.82], radius_deg: 0.0 },
        Light::Point { position: [0.5, 1.52, 6.5], intensity: 5.0, color: warm, radius: 0.0 },
        spot([4.3, 1.78, 5.7], [0.0, -1.0, 0.0], 58.0, 10.0),
        spot([1.9, 2.6, 1.1], [0.0, -1.0, -0.15], 56.0, 10.0),
        Light::Point { position: [5.98, 0.85, 4.62], intensity: 2.5, color: warm, radius: 0.0 },
        spot([8.55, 0.98, 0.62], [-0.5, -1.0, 0.3], 52.0, 5.0),
    ]
}

/// Floor, ceiling, walls with doors and windows.
fn shell(mesh: &mut WorldMesh) {
    let low = DVec3::ZERO - DVec3::splat(OUTER);
    let high = ROOM + DVec3::splat(OUTER);
    block(mesh, low, dvec3(high.x, 0.0, high.z), Is::Floor as u32);
    block(mesh, dvec3(low.x, ROOM.y, low.z), high, Is::White as u32);
    let south: [Hole; 3] = [[0.9, 2.7, 0.25, 2.3], [3.2, 5.0, 0.25, 2.3], [6.5, 8.1, 0.8, 2.25]];
    let west: [Hole; 2] = [[0.9, 2.1, 1.2, 2.2], [4.0, 5.6, 0.8, 2.25]];
    let east: [Hole; 1] = [[0.7, 2.0, 0.9, 2.2]];
    let outer = |mesh: &mut WorldMesh, axis, thick, ends, holes: &[Hole]| {
        wall(mesh, axis, thick, ends, [0.0, ROOM.y], holes, Is::Wall as u32);
    };
    outer(mesh, 0, [ROOM.z, high.z], [low.x, high.x], &south);
    outer(mesh, 0, [low.z, 0.0], [low.x, high.x], &[]);
    outer(mesh, 2, [low.x, 0.0], [0.0, ROOM.z], &west);
    outer(mesh, 2, [ROOM.x, high.x], [0.0, ROOM.z], &east);
    let frame = |mesh: &mut WorldMesh, axis, at, hole| window(mesh, axis, at, hole, 2, Is::White as u32);
    south.iter().for_each(|hole| frame(mesh, 0, ROOM.z + 0.12, hole));
    west.iter().for_each(|hole| frame(mesh, 2, -0.12, hole));
    frame(mesh, 2, ROOM.x + 0.12, &east[0]);
    let between = |mesh: &mut WorldMesh, axis, at: f64, ends, holes: &[Hole], is: Is| {
        wall(mesh, axis, [at - INNER, at + INNER], ends, [0.0, ROOM.y], holes, is as u32);
    };
    between(mesh, 0, 2.74, [0.0, ROOM.x], &[[0.7, 3.1, 0.0, 2.35], [4.5, 5.4, 0.0, 2.05]], Is::Wall);
    between(mesh, 2, 5.66, [2.74 + INNER, ROOM.z], &[[3.1, 4.0, 0.0, 2.05]], Is::Accent);
    between(mesh, 2, 4.06, [0.0, 2.74 - INNER], &[], Is::Wall);
    between(mesh, 2, 6.06, [0.0, 2.74 - INNER], &[[0.9, 1.8, 0.0, 2.05]], Is::Wall);
}
