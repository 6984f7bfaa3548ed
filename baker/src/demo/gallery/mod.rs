//! A gallery of modern art: a hall under skylights and a band of windows to the north, and a dark room with a screen
//! behind it. Paintings in spots, a sculpture in the sun, a ring of neon. Metres; x points east, z south.

mod building;
mod works;

use super::sky::add_clear_sky;
use super::{camera, matt, shining};
use crate::scene::Scene;
use crate::scene::world_mesh::WorldMesh;
use glam::{DVec3, dvec3};
use rebounce_shared::light::Light;

/// Width (x), height (y) and depth (z) of the hall.
const HALL: DVec3 = dvec3(12.0, 4.4, 8.0);
/// The dark room east of the hall: where it begins and ends along x and z, and its height.
const DARK: [[f64; 2]; 2] = [[12.3, 17.5], [2.2, 8.0]];
const DARK_HEIGHT: f64 = 3.6;

/// What surfaces are made of: materials, by index into [`MATERIALS`] and then [`SHINING`].
#[derive(Clone, Copy)]
enum Finish {
    Wall,
    Floor,
    DarkWall,
    Frame,
    Oak,
    Black,
    Steel,
    Red,
    Orange,
    Yellow,
    Green,
    Blue,
    Navy,
    Pink,
    Ink,
    Canvas,
    Sand,
    Neon,
    /// The screen's colours.
    Magenta,
    Violet,
    Azure,
    Cyan,
    Amber,
}

/// Names and linear RGB albedos, in the order of [`Finish`].
const MATERIALS: [(&str, [f32; 3]); 17] = [
    ("wall", [0.78, 0.77, 0.74]),
    ("pale oak floor", [0.52, 0.42, 0.31]),
    ("dark wall", [0.13, 0.13, 0.16]),
    ("frame", [0.66, 0.66, 0.66]),
    ("oak", [0.5, 0.34, 0.19]),
    ("black", [0.03, 0.03, 0.032]),
    ("steel", [0.42, 0.43, 0.45]),
    ("cadmium red", [0.58, 0.05, 0.035]),
    ("orange", [0.72, 0.24, 0.04]),
    ("yellow", [0.76, 0.56, 0.06]),
    ("viridian", [0.05, 0.27, 0.16]),
    ("cobalt blue", [0.04, 0.12, 0.5]),
    ("navy", [0.02, 0.035, 0.12]),
    ("pink", [0.74, 0.36, 0.4]),
    ("ink", [0.035, 0.03, 0.03]),
    ("canvas", [0.72, 0.68, 0.58]),
    ("sand", [0.52, 0.4, 0.25]),
];

/// Shining materials, which follow: name, light group, albedo, radiance in nits.
const SHINING: [(&str, &str, [f32; 3], [f32; 3]); 6] = [
    ("neon", "Neon", [0.3, 0.2, 0.2], [24.0, 3.2, 5.0]),
    ("screen: magenta", "Screen", SCREEN, [3.2, 0.3, 1.6]),
    ("screen: violet", "Screen", SCREEN, [1.2, 0.4, 3.0]),
    ("screen: azure", "Screen", SCREEN, [0.3, 1.3, 3.6]),
    ("screen: cyan", "Screen", SCREEN, [0.4, 2.6, 2.8]),
    ("screen: amber", "Screen", SCREEN, [4.2, 2.3, 0.5]),
];
/// Albedo of a screen.
const SCREEN: [f32; 3] = [0.04; 3];

/// Direction of the sun's light, shortly after noon.
const SUN: [f64; 3] = [0.3, -0.82, -0.49];
/// Factor of the sky's radiance, and the sun's illuminance, lux: dimmed alike beside the lamps.
const SKY: f64 = 0.4;
const SUN_LUX: f64 = 42.0;

pub(super) fn scene() -> Scene {
    let mut mesh = WorldMesh::default();
    building::add(&mut mesh);
    works::add(&mut mesh);
    let plain = MATERIALS.iter().map(|(name, albedo)| (matt(name, *albedo), None));
    let bright = SHINING.iter().map(|(name, group, albedo, emission)| {
        (shining(name, *albedo, *emission), Some((*group).to_owned()))
    });
    let (materials, light_groups) = plain.chain(bright).unzip();
    let (lights, names): (Vec<Light>, Vec<&str>) = lights().into_iter().unzip();
    let look = |position: [f64; 3], target: [f64; 3]| camera(position, target, 58.0);
    let mut scene = Scene {
        name: "gallery".into(),
        materials,
        light_groups,
        lights,
        light_names: names.into_iter().map(str::to_owned).collect(),
        camera_names: ["Hall", "Paintings", "Screen"].map(str::to_owned).into(),
        cameras: vec![
            look([0.9, 1.65, 6.7], [8.4, 1.75, 2.6]),
            look([9.6, 1.65, 1.6], [4.2, 1.75, 7.6]),
            look([12.9, 1.6, 3.0], [16.6, 1.5, 6.6]),
        ],
        ..Scene::default()
    };
    add_clear_sky(&mut scene, SUN, SKY);
    mesh.finish(&mut scene);
    scene
}

/// The sun, and a spot for each painting of the south wall, with their names.
fn lights() -> Vec<(Light, &'static str)> {
    let sun =
        Light::Directional { direction: SUN, intensity: SUN_LUX, color: [1.0, 0.94, 0.84], radius_deg: 0.0 };
    let spots = works::SOUTH.map(|work| {
        let position = building::spot_at(work.x);
        let spot = Light::Spot {
            position: position.to_array(),
            direction: (dvec3(work.x, work.height, HALL.z) - position).to_array(),
            outer_cone_deg: 30.0,
            inner_cone_deg: Some(17.0),
            intensity: 22.0,
            color: [1.0, 0.86, 0.68],
            radius: 0.0,
        };
        (spot, work.name)
    });
    std::iter::once((sun, "Sun")).chain(spots).collect()
}
