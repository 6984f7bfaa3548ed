//! A fluted vase on a plinth in a room: an object with more detail than the room around it.

use glam::Vec3;
use rebounce::io::files::Memory;
use rebounce::io::{GroupOption, LoadOptions, load_from};
use rebounce::scene::{Scene, SceneError};
use rebounce_shared::camera::Camera;
use rebounce_shared::light::Light;
use serde_json::json;
use std::f32::consts::TAU;

/// Name of the vase's node.
pub const VASE: &str = "vase";
/// Height of the plinth, metres.
const PLINTH: f32 = 0.9;
/// Height of the vase.
const HEIGHT: f32 = 0.5;
/// Squares around and up the vase.
const GRID: [usize; 2] = [144, 40];
const FLUTES: f32 = 12.0;

/// Positions, normals and triangles.
#[derive(Default)]
struct Mesh {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    indices: Vec<u32>,
}

impl Mesh {
    fn quad(&mut self, corners: [Vec3; 4]) {
        let first = self.positions.len() as u32;
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize();
        self.positions.extend(corners);
        self.normals.extend([normal; 4]);
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }

    /// A box between two corners, seen from outside or from within.
    fn block(&mut self, low: Vec3, high: Vec3, is_inward: bool) {
        for axis in 0..3 {
            for is_high in [false, true] {
                let corner = |u: bool, v: bool| {
                    let mut at = low;
                    at[axis] = if is_high { high[axis] } else { low[axis] };
                    at[(axis + 1) % 3] = if u { high } else { low }[(axis + 1) % 3];
                    at[(axis + 2) % 3] = if v { high } else { low }[(axis + 2) % 3];
                    at
                };
                let mut round =
                    [corner(false, false), corner(true, false), corner(true, true), corner(false, true)];
                if is_high == is_inward {
                    round.reverse();
                }
                self.quad(round);
            }
        }
    }
}

/// A place on the vase; `u` goes around it, `v` up from its foot to its lip, both from 0 to 1.
fn place(u: f32, v: f32) -> Vec3 {
    let belly = 0.06 + 0.1 * (std::f32::consts::PI * (0.15 + 0.8 * v)).sin();
    let radius = belly * (1.0 + 0.16 * (FLUTES * TAU * u).cos() * (1.0 - v * v));
    let (sin, cos) = (TAU * u).sin_cos();
    Vec3::new(radius * cos, PLINTH + HEIGHT * v, -radius * sin)
}

fn vase() -> Mesh {
    let [around, up] = GRID;
    let mut out = Mesh::default();
    for j in 0..=up {
        for i in 0..=around {
            let (u, v) = (i as f32 / around as f32, j as f32 / up as f32);
            let step = 1e-3;
            let tangents = [place(u + step, v) - place(u - step, v), place(u, v + step) - place(u, v - step)];
            out.positions.push(place(u, v));
            out.normals.push(tangents[0].cross(tangents[1]).normalize());
        }
    }
    for j in 0..up as u32 {
        for i in 0..around as u32 {
            let a = j * (around as u32 + 1) + i;
            let b = a + around as u32 + 1;
            out.indices.extend([a, a + 1, b + 1, a, b + 1, b]);
        }
    }
    out
}

/// The scene; the vase is a reconstruction group of this density, if one is given.
///
/// # Errors
/// [`SceneError`] of the reader.
pub fn scene(density: Option<f32>) -> Result<Scene, SceneError> {
    let (mut room, mut plinth) = (Mesh::default(), Mesh::default());
    room.block(Vec3::new(-2.0, 0.0, -2.0), Vec3::new(2.0, 2.6, 2.0), true);
    plinth.block(Vec3::new(-0.2, 0.0, -0.2), Vec3::new(0.2, PLINTH, 0.2), false);
    let mut bytes = Vec::new();
    let (mut views, mut accessors, mut meshes) = (Vec::new(), Vec::new(), Vec::new());
    for (material, mesh) in [room, plinth, vase()].into_iter().enumerate() {
        let mut add = |data: &[u8], kind: &str, component: u32, count: usize| {
            views.push(json!({ "buffer": 0, "byteOffset": bytes.len(), "byteLength": data.len() }));
            bytes.extend_from_slice(data);
            accessors.push(json!({
                "bufferView": views.len() - 1, "componentType": component, "count": count, "type": kind,
            }));
            accessors.len() - 1
        };
        let position = add(bytemuck::cast_slice(&mesh.positions), "VEC3", 5126, mesh.positions.len());
        let normal = add(bytemuck::cast_slice(&mesh.normals), "VEC3", 5126, mesh.normals.len());
        let indices = add(bytemuck::cast_slice(&mesh.indices), "SCALAR", 5125, mesh.indices.len());
        meshes.push(json!({ "primitives": [{
            "attributes": { "POSITION": position, "NORMAL": normal }, "indices": indices, "material": material,
        }] }));
    }
    let matt = |color: [f32; 3]| {
        json!({ "doubleSided": true, "pbrMetallicRoughness": {
        "baseColorFactor": [color[0], color[1], color[2], 1.0], "metallicFactor": 0.0,
    } })
    };
    let document = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0, 1, 2] }],
        "nodes": [{ "mesh": 0 }, { "mesh": 1 }, { "mesh": 2, "name": VASE }],
        "meshes": meshes,
        "materials": [matt([0.7, 0.68, 0.64]), matt([0.6, 0.55, 0.5]), matt([0.75, 0.35, 0.2])],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": bytes.len(), "uri": "vase.bin" }],
    });
    let files = Memory::from_iter([("vase.gltf", document.to_string().into_bytes()), ("vase.bin", bytes)]);
    let groups = density.map(|density| GroupOption { name: VASE.to_owned(), density });
    let options = LoadOptions { groups: groups.into_iter().collect(), ..LoadOptions::default() };
    let mut scene = load_from(&files, "vase.gltf".as_ref(), &options)?;
    let color = [1.0, 0.92, 0.8];
    scene.lights = vec![Light::Point { position: [1.3, 2.2, -1.0], intensity: 25.0, color, radius: 0.0 }];
    scene.cameras = vec![near(), room_camera()];
    Ok(scene)
}

/// A camera that sees the vase and little else.
pub fn near() -> Camera {
    Camera { position: [-0.35, 1.3, 0.85], target: [0.0, 1.15, 0.0], up: [0.0, 1.0, 0.0], yfov_deg: 36.0 }
}

/// A camera that sees the room.
pub fn room_camera() -> Camera {
    Camera { position: [-1.6, 1.6, 1.8], target: [0.4, 0.9, -0.4], up: [0.0, 1.0, 0.0], yfov_deg: 60.0 }
}
