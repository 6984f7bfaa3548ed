//! Two rooms, 4 m by 4 m and 2.5 m high, with a dividing wall 5 cm thick: leaks through the wall are visible. Floor,
//! ceiling and long walls run on under and past the dividing wall, as modellers leave them.

use super::{block, camera, matt};
use crate::scene::Scene;
use crate::scene::groups::{NodeGroups, assign};
use crate::scene::world_mesh::{WorldInstancedMesh, WorldMesh};
use glam::{DAffine3, DVec3, dvec3};
use rebounce_shared::elementary::Elementary;
use rebounce_shared::light::Light;
use rebounce_shared::rbn::groups::{Group, Node};

const HALF_WALL: f64 = 0.025;
const DEPTH: f64 = 4.0;
const HEIGHT: f64 = 2.5;
const END: f64 = 4.0 + HALF_WALL;
/// Hinge of the leaf, on the wall's face in the right room.
const HINGE: DVec3 = dvec3(HALF_WALL, 0.0, 0.98);
/// Thickness, height and width of the leaf: it overlaps the wall by 2 cm around the doorway.
const LEAF: DVec3 = dvec3(0.04, 2.02, 0.94);

/// What is between the rooms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Door {
    /// A wall.
    None,
    /// A doorway, 0.9 m wide and 2 m high: light reaches the right room.
    Open,
    /// The doorway with a leaf that may move, turned into the right room by so many degrees; at 0 it closes the doorway.
    Leaf(f64),
}

/// Adds the leaf, a node that turns about its hinge.
fn add_leaf(mesh: &mut WorldMesh, material: u32, turned_deg: f64) -> NodeGroups {
    let mut leaf = WorldMesh::default();
    block(&mut leaf, DVec3::ZERO, LEAF, material);
    let name = || "leaf".to_owned();
    let (sine, cosine) = turned_deg.to_radians().sine_cosine();
    // From +z towards +x, as motions of nodes.
    let turn = glam::DMat3::from_cols(dvec3(cosine, 0.0, -sine), DVec3::Y, dvec3(sine, 0.0, cosine));
    mesh.in_models = (leaf.positions.len(), leaf.triangles.len());
    mesh.models.push(WorldInstancedMesh {
        mesh: leaf,
        world_from_model: vec![DAffine3::from_mat3_translation(turn, HINGE)],
        group: 1,
    });
    NodeGroups {
        nodes: vec![Node { name: name(), parent: None, origin: HINGE.to_array() }],
        groups: vec![Group { name: name(), density: 1.0, node: Some(0) }],
        pivots: vec![HINGE],
    }
}

/// The lamp is in the left room; the first camera looks into the right room.
pub(super) fn scene(name: &str, door: Door) -> Scene {
    let mut mesh = WorldMesh::default();
    mesh.room(dvec3(-END, 0.0, 0.0), dvec3(END, HEIGHT, DEPTH), [0, 1, 1, 2, 3, 1]);
    let wall = |mesh: &mut WorldMesh, low: [f64; 2], high: [f64; 2]| {
        block(mesh, dvec3(-HALF_WALL, low[0], low[1]), dvec3(HALF_WALL, high[0], high[1]), 1);
    };
    if door != Door::None {
        wall(&mut mesh, [0.0, 0.0], [HEIGHT, 1.0]);
        wall(&mut mesh, [0.0, 1.9], [HEIGHT, DEPTH]);
        wall(&mut mesh, [2.0, 1.0], [HEIGHT, 1.9]);
    } else {
        wall(&mut mesh, [0.0, 0.0], [HEIGHT, DEPTH]);
    }
    let look = |position: DVec3, target: DVec3| camera(position, target, 65.0);
    let mut scene = Scene {
        name: name.into(),
        materials: vec![
            matt("floor", [0.45, 0.32, 0.2]),
            matt("white", [0.75, 0.75, 0.72]),
            matt("red", [0.6, 0.12, 0.1]),
            matt("blue", [0.1, 0.2, 0.6]),
        ],
        lights: vec![Light::Spot {
            position: [-2.2, 2.3, 2.6],
            direction: [0.5, -1.0, -0.55],
            outer_cone_deg: 55.0,
            inner_cone_deg: Some(45.0),
            intensity: 60.0,
            color: [1.0, 0.92, 0.8],
            radius: 0.0,
        }],
        cameras: vec![
            look(dvec3(3.6, 1.6, 3.6), dvec3(0.2, 1.0, 0.9)),
            look(dvec3(-3.6, 1.6, 3.6), dvec3(-0.2, 1.0, 0.9)),
        ],
        ..Scene::default()
    };
    if let Door::Leaf(turned_deg) = door {
        scene.materials.push(matt("leaf", [0.55, 0.5, 0.4]));
        let groups = add_leaf(&mut mesh, scene.materials.len() as u32 - 1, turned_deg);
        assign(&mut scene, &mut mesh, groups, &[]);
    }
    mesh.finish(&mut scene);
    scene
}
