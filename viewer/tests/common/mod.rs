//! A small synthetic baked room, and a device.

use rebounce_shared::baked::BakedScene;
use rebounce_shared::camera::Camera;
use rebounce_shared::colour::pack_rgb9e5;
use rebounce_shared::footprint;
use rebounce_shared::glam::Vec3;
use rebounce_shared::light::Light;
use rebounce_shared::link::{LaterLink, Link, SourceLink};
use rebounce_shared::octahedral::pack_snorm16;
use rebounce_shared::rbn::LinkMatrix;
use rebounce_shared::rbn::bulk::{Cut, Point, Vertex};
use rebounce_shared::rbn::light_groups::{LightGroup, LightGroups};
use rebounce_shared::rbn::meta::{Draw, Level, Material, Meta};
use rebounce_shared::rbn::sources::{EmissiveGroup, Sources};

#[path = "../device/mod.rs"]
mod device;
#[allow(dead_code, reason = "not all tests draw")]
mod screen;
pub use device::gpu;
#[allow(unused_imports, reason = "not all tests draw")]
pub use screen::screen;

/// A number in [0, 1) from a seed.
pub fn random(seed: u32) -> f32 {
    let mut x = seed.wrapping_mul(0x9e37_79b9) ^ 0x85eb_ca6b;
    x = (x ^ (x >> 16)).wrapping_mul(0x7feb_352d);
    x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
    ((x ^ (x >> 16)) >> 8) as f32 / (1 << 24) as f32
}

/// The walls of the cube [-1, 1]³: inward normal, and two axes.
const WALLS: [[Vec3; 3]; 6] = [
    [Vec3::X, Vec3::Y, Vec3::Z],
    [Vec3::NEG_X, Vec3::Z, Vec3::Y],
    [Vec3::Y, Vec3::Z, Vec3::X],
    [Vec3::NEG_Y, Vec3::X, Vec3::Z],
    [Vec3::Z, Vec3::X, Vec3::Y],
    [Vec3::NEG_Z, Vec3::Y, Vec3::X],
];

/// A closed room, the cube [-1, 1]³ seen from inside. Every level has `side`² points a wall. The links are
/// arbitrary, but cover the format: signs, directions, rows of all lengths.
pub fn room(sides: &[u32]) -> BakedScene {
    let mut scene = BakedScene::default();
    let mut meta =
        Meta { scene_name: "room".into(), bounds_min: [-1.0; 3], bounds_max: [1.0; 3], ..Meta::default() };
    for (wall, [normal, u, v]) in WALLS.iter().enumerate() {
        let first = scene.vertices.len() as u32;
        for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
            let position = (-*normal + *u * a + *v * b).to_array();
            scene.vertices.push(Vertex { position, normal: pack_snorm16(*normal), uv: [a, b] });
        }
        scene.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
        meta.materials.push(Material {
            base_color: [0.3 + 0.1 * wall as f32, 0.8 - 0.1 * wall as f32, 0.5, 1.0],
            ..Material::default()
        });
        meta.draws.push(Draw { material: wall as u32, first_index: 6 * wall as u32, index_count: 6 });
    }
    for (l, &side) in sides.iter().enumerate() {
        let (first, spacing) = (scene.points.len() as u32, 2.0 / side as f32);
        for (wall, [normal, u, v]) in WALLS.iter().enumerate() {
            for i in 0..side * side {
                let shake =
                    |k: u32| 0.4 * (random(l as u32 * 7919 + wall as u32 * 104_729 + i * 3 + k) - 0.5);
                let a = ((i % side) as f32 + 0.5 + shake(0)) * spacing - 1.0;
                let b = ((i / side) as f32 + 0.5 + shake(1)) * spacing - 1.0;
                let planes = [Cut::new(*u, 0.8 * spacing), Cut::new(-*v, 0.8 * spacing)];
                let cuts = &planes[..(i % 3 == 0) as usize + (i % 6 == 0) as usize];
                let (position, radius) = (-*normal + *u * a + *v * b, 1.6 * spacing);
                // Samples within the room; every fifth point has no samples.
                let inside = |k: &u32| {
                    let place = position + footprint::offset(*k, *normal, radius);
                    i % 5 != 0 && place.abs().max_element() < 0.99
                };
                let samples = (0..footprint::SAMPLES).filter(inside).fold(0, |bits, k| bits | 1 << k);
                scene.points.push(Point {
                    position: position.to_array(),
                    radius,
                    normal: pack_snorm16(*normal),
                    // Every third support ends halfway along u, every sixth along −v too.
                    cuts: Point::pack_cuts(scene.cuts.len(), cuts.len(), samples),
                    tint: pack_rgb9e5(Vec3::new(0.7 + shake(5), 1.0 + shake(6), 1.3 + shake(7))),
                });
                scene.cuts.extend(cuts);
            }
        }
        let count = scene.points.len() as u32 - first;
        meta.levels.push(Level { first, count, disk_radius: spacing, support_radius: 1.6 * spacing });
    }
    meta.sender_levels = 2.min(sides.len() as u32);
    meta.later_levels = 1;
    meta.direct_levels = sides.len() as u32;
    meta.cameras.push(Camera {
        position: [0.2, 0.1, 0.9],
        target: [-0.1, -0.2, -1.0],
        up: [0.0, 1.0, 0.0],
        yfov_deg: 70.0,
    });
    meta.lights.push(lamp([0.3, 0.4, 0.2]));
    scene.meta = meta;
    assert!(scene.relate().is_ok(), "points keep their distance");
    link(&mut scene);
    scene
}

/// A lamp in the room.
pub fn lamp(position: [f64; 3]) -> Light {
    Light::Point { position, intensity: 3.0, color: [1.0, 0.7, 0.4], radius: 0.0 }
}

/// Gives a scene arbitrary links.
pub fn link(scene: &mut BakedScene) {
    let senders = scene.sender_count() as u32;
    let all = scene.points.len() as u32;
    let random_size = |shift: &dyn Fn(u32) -> f32| (shift(7) * 6.0).exp2() * 0.02;
    scene.links = LinkMatrix::from_rows(&rows(0..all, senders, 0, |sender, shift| {
        Link::pack(sender, (shift(4) + 0.3) * random_size(shift))
    }));
    let coarse = scene.later_count() as u32;
    scene.later = LinkMatrix::from_rows(&rows(0..coarse, coarse, 0x1234, |sender, shift| {
        let colour = Vec3::new(shift(4) + 0.6, shift(5) + 0.5, shift(6) + 0.5);
        LaterLink::pack(sender, colour * random_size(shift))
    }));
}

#[allow(dead_code, reason = "not all tests have sources")]
/// Adds a sky and two groups of emissive surfaces, one of them coloured, with arbitrary links.
pub fn add_sources(scene: &mut BakedScene) {
    let group = |material: u32, is_coloured| EmissiveGroup {
        name: format!("panel {material}"),
        materials: vec![material],
        step: [0.02, 0.015, 0.01],
        is_coloured,
    };
    scene.sources = Sources {
        has_sky: true,
        sky_step: 1e-3,
        groups: vec![group(0, false), group(1, true)],
        environment: vec![],
    };
    let (all, sources) = (scene.points.len() as u32, scene.sources.count() as u32);
    scene.source_links = LinkMatrix::from_rows(&rows(0..all, sources, 0x4321, |source, shift| {
        SourceLink::pack(source, (shift(4) * 200.0 + 40.0) as i32)
    }));
}

#[allow(dead_code, reason = "not all tests are of solutions")]
/// Makes the room a fixed solution: links go, and of three groups of light one has a column of direct light. Irradiance
/// is arbitrary, of all sizes and colours; a third of the points of the finest level is not stored.
pub fn solve(scene: &mut BakedScene) {
    let rows = scene.points.len();
    scene.links = LinkMatrix::from_rows(&vec![Vec::new(); rows]);
    scene.later = LinkMatrix::from_rows(&vec![Vec::new(); scene.later_count()]);
    scene.meta.lights = vec![lamp([0.3, 0.4, 0.2]), lamp([-0.5, 0.1, 0.6])];
    scene.meta.lights.push(Light::Emissive { group: 0, intensity: 1.0, color: [1.0; 3] });
    let group = |k: u32| LightGroup { floor: 1e-4 * f32::from(k as u8 + 1), has_direct: k == 2 };
    let mut all = LightGroups { groups: (0..3).map(group).collect(), values: Vec::new() };
    let columns: Vec<usize> = all.column_groups().collect();
    assert_eq!(columns, [0, 1, 2, 2]);
    for (column, group) in columns.into_iter().enumerate() {
        let value = |i: usize, k: u32| {
            let seed = (column * rows + i) as u32 * 4;
            (random(seed) * 10.0 - 7.0).exp2() * (0.05 + random(seed + 1 + k))
        };
        let irradiance: Vec<Vec3> =
            (0..rows).map(|i| Vec3::new(value(i, 0), value(i, 1), value(i, 2))).collect();
        let is_stored = |i: usize| !i.is_multiple_of(3) || i < scene.sender_count();
        all.push_column(&irradiance, all.groups[group].floor, scene.relations.push(), is_stored);
    }
    scene.light_groups = all;
}

/// Random rows: empty, short and long; `link` makes a link from its sender and random numbers in -0.5..0.5.
fn rows<L>(
    receivers: std::ops::Range<u32>,
    senders: u32,
    seed: u32,
    link: impl Fn(u32, &dyn Fn(u32) -> f32) -> L,
) -> Vec<Vec<L>> {
    let row = |receiver: u32| {
        let share = [0.0, 0.02, 0.3, 0.9][(random(receiver ^ seed) * 4.0) as usize];
        let seed_of = |sender: u32| (receiver * senders + sender) ^ seed;
        let linked = (0..senders).filter(|sender| random(seed_of(*sender) ^ 0x5555) < share);
        linked.map(|sender| link(sender, &|k| random(seed_of(sender).wrapping_mul(7) ^ k) - 0.5)).collect()
    };
    receivers.map(row).collect()
}
