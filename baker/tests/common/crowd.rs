//! A room with copies of a mesh, as a glTF file.

use glam::{DQuat, DVec3};
use serde_json::{Value, json};

/// Numbers of upright and of mirrored copies.
pub const COPIES: [usize; 2] = [60, 50];
/// Triangles of the mesh.
pub const FINE: usize = 2 * 40 * 20;

/// Placement of each copy: translation, rotation, scale. The last two are too flat and too small for a model.
pub fn places() -> Vec<[Vec<f64>; 3]> {
    let place = |i: usize| {
        let at = DVec3::new(
            (i % 11) as f64 - 5.0,
            0.6 + 0.35 * ((i / 11) % 5) as f64,
            (i / 11) as f64 * 0.9 - 4.5,
        );
        let turn = DQuat::from_axis_angle(DVec3::new(0.3, 1.0, 0.2).normalize(), 0.7 * i as f64);
        let size = 0.15 + 0.02 * (i % 7) as f64;
        let mirror = if i < COPIES[0] { 1.0 } else { -1.0 };
        let scale = match i {
            110 => DVec3::new(0.3, 0.0, 0.3),
            111 => DVec3::splat(1e-4),
            // Stretched along one axis.
            _ if i.is_multiple_of(4) => DVec3::new(mirror * size, 1.8 * size, size),
            _ => DVec3::new(mirror * size, size, size),
        };
        [at.to_array().to_vec(), turn.to_array().to_vec(), scale.to_array().to_vec()]
    };
    (0..COPIES[0] + COPIES[1] + 2).map(place).collect()
}

/// Encoding of the copies in the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Said {
    /// One node per copy, with a shared mesh.
    Nodes,
    /// EXT_mesh_gpu_instancing.
    Instances,
    /// One node and one mesh per copy.
    Alone,
}

/// A room, 12 by 4 by 10, seen from the inside, with bumpy balls; the material's alpha is 1 where opaque.
pub fn glb(said: Said) -> Vec<u8> {
    let mut bin: Vec<u8> = Vec::new();
    let (mut views, mut accessors) = (Vec::new(), Vec::new());
    let mut floats = |bin: &mut Vec<u8>, kind: &str, width: usize, numbers: &[f32], bounds: bool| {
        views.push(json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": 4 * numbers.len() }));
        let mut accessor = json!({
            "bufferView": views.len() - 1, "componentType": 5126, "type": kind, "count": numbers.len() / width,
        });
        if bounds {
            let of = |fold: fn(f32, f32) -> f32, from: f32| -> Vec<f32> {
                (0..width).map(|k| numbers.iter().skip(k).step_by(width).copied().fold(from, fold)).collect()
            };
            accessor["min"] = json!(of(f32::min, f32::INFINITY));
            accessor["max"] = json!(of(f32::max, f32::NEG_INFINITY));
        }
        accessors.push(accessor);
        bin.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
        accessors.len() - 1
    };
    let (ball, room) = (ball(), room());
    let primitive = |[positions, normals]: [usize; 2], material: usize| json!({ "attributes": { "POSITION": positions, "NORMAL": normals }, "material": material });
    let mut both = |parts: &[Vec<f32>; 2]| {
        [floats(&mut bin, "VEC3", 3, &parts[0], true), floats(&mut bin, "VEC3", 3, &parts[1], false)]
    };
    // The ball has two materials.
    let halves =
        [0, 1].map(|half| ball.each_ref().map(|all| all[half * all.len() / 2..][..all.len() / 2].to_vec()));
    let ball = [primitive(both(&halves[0]), 1), primitive(both(&halves[1]), 2)];
    let room = primitive(both(&room), 0);
    let places = places();
    let mut meshes = vec![json!({ "primitives": [room] })];
    let mut nodes = vec![json!({ "mesh": 0 })];
    let mut used = json!([]);
    match said {
        Said::Instances => {
            let all = |k: usize| -> Vec<f32> {
                places.iter().flat_map(|p| p[k].iter().map(|x| *x as f32)).collect()
            };
            let attributes: Value =
                [("TRANSLATION", "VEC3", 3), ("ROTATION", "VEC4", 4), ("SCALE", "VEC3", 3)]
                    .iter()
                    .enumerate()
                    .map(|(k, (name, kind, width))| {
                        (name.to_string(), json!(floats(&mut bin, kind, *width, &all(k), false)))
                    })
                    .collect::<serde_json::Map<_, _>>()
                    .into();
            meshes.push(json!({ "primitives": ball }));
            nodes.push(json!({
                "mesh": 1, "extensions": { "EXT_mesh_gpu_instancing": { "attributes": attributes } },
            }));
            used = json!(["EXT_mesh_gpu_instancing"]);
        }
        Said::Nodes | Said::Alone => {
            for [translation, rotation, scale] in &places {
                if said == Said::Alone || meshes.len() == 1 {
                    meshes.push(json!({ "primitives": ball.clone() }));
                }
                nodes.push(json!({
                    "mesh": meshes.len() - 1, "translation": translation, "rotation": rotation, "scale": scale,
                }));
            }
        }
    }
    let color = |rgba: [f64; 4]| json!({ "pbrMetallicRoughness": { "baseColorFactor": rgba, "metallicFactor": 0.0 } });
    let mut json = json!({
        "asset": { "version": "2.0" },
        "extensionsUsed": used,
        "scene": 0,
        "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": meshes,
        "materials": [color([0.7, 0.7, 0.6, 1.0]), color([0.3, 0.5, 0.7, 1.0]), color([0.5, 0.2, 0.3, 1.0])],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{ "byteLength": bin.len() }],
    })
    .to_string()
    .into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    bin.resize(bin.len().next_multiple_of(4), 0);
    let mut file = b"glTF".to_vec();
    let words = |words: &[u32]| words.iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>();
    file.extend(words(&[2, (28 + json.len() + bin.len()) as u32, json.len() as u32]));
    file.extend(b"JSON");
    file.extend(json);
    file.extend(words(&[bin.len() as u32]));
    file.extend(b"BIN\0");
    file.extend(bin);
    file
}

/// Positions and normals, three vertices a triangle.
fn ball() -> [Vec<f32>; 2] {
    let at = |i: usize, j: usize| {
        let (u, v) = (i as f64 / 40.0 * std::f64::consts::TAU, j as f64 / 20.0 * std::f64::consts::PI);
        let normal = DVec3::new(v.sin() * u.cos(), v.cos(), v.sin() * u.sin());
        // Off the origin of the mesh.
        let bump = 1.0 + 0.1 * (3.0 * v).sin() * (5.0 * u).sin();
        (normal * bump + DVec3::new(3.0, 1.0, -2.0), normal)
    };
    let mut out = [Vec::new(), Vec::new()];
    for i in 0..40 {
        for j in 0..20 {
            for (i, j) in [(i, j), (i + 1, j), (i + 1, j + 1), (i, j), (i + 1, j + 1), (i, j + 1)] {
                let (position, normal) = at(i % 40, j);
                // Twisted, so that mirrored copies differ.
                let position = position + DVec3::X * 0.3 * position.y * position.y;
                out[0].extend(position.as_vec3().to_array());
                out[1].extend(normal.as_vec3().to_array());
            }
        }
    }
    out
}

fn room() -> [Vec<f32>; 2] {
    let mut out = [Vec::new(), Vec::new()];
    let half = DVec3::new(6.0, 2.0, 5.0);
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let corner = |u: f64, v: f64| {
                let mut p = DVec3::ZERO;
                p[axis] = side;
                p[(axis + 1) % 3] = u;
                p[(axis + 2) % 3] = -side * v;
                p * half + DVec3::Y * 2.0
            };
            let mut normal = DVec3::ZERO;
            normal[axis] = -side;
            for (u, v) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                out[0].extend(corner(u, v).as_vec3().to_array());
                out[1].extend(normal.as_vec3().to_array());
            }
        }
    }
    out
}
