//! A file with what animations deform: a strip of two bones, a triangle with morph targets, and a floor that stands.

use super::super::base64;
use glam::{DMat4, DVec3};
use serde_json::{Value, json};

/// A glTF file in the making.
#[derive(Clone, Default)]
pub(super) struct Maker {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Maker {
    /// Adds an accessor; returns its number.
    fn add(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8]) -> usize {
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(json!({ "buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len() }));
        self.bytes.extend_from_slice(bytes);
        let view = self.views.len() - 1;
        self.accessors
            .push(json!({ "bufferView": view, "componentType": component, "count": count, "type": kind }));
        self.accessors.len() - 1
    }

    pub(super) fn floats(&mut self, kind: &str, numbers: &[f32]) -> usize {
        let width = match kind {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            _ => 16,
        };
        let bytes: Vec<u8> = numbers.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.add(5126, kind, numbers.len() / width, &bytes)
    }

    pub(super) fn joints(&mut self, joints: &[[u8; 4]]) -> usize {
        self.add(5121, "VEC4", joints.len(), joints.as_flattened())
    }

    pub(super) fn indices(&mut self, indices: &[u16]) -> usize {
        let bytes: Vec<u8> = indices.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.add(5123, "SCALAR", indices.len(), &bytes)
    }

    /// The file, with these members of its root.
    pub(super) fn finish(self, mut root: Value) -> String {
        root["asset"] = json!({ "version": "2.0" });
        root["accessors"] = self.accessors.into();
        root["bufferViews"] = self.views.into();
        let uri = format!("data:application/octet-stream;base64,{}", base64(&self.bytes));
        root["buffers"] = json!([{ "byteLength": self.bytes.len(), "uri": uri }]);
        root.to_string()
    }
}

/// Rows of the strip's vertices.
const ROWS: usize = 9;

/// The strip's mesh and the matrices of its skin: along y, from joint 0 at y = 0 to joint 1 at y = 1.
pub(super) fn strip(maker: &mut Maker) -> (Value, usize) {
    let (mut positions, mut normals, mut joints, mut weights, mut indices) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for row in 0..ROWS {
        let y = 2.0 * row as f32 / (ROWS - 1) as f32;
        let share = ((y - 0.5).clamp(0.0, 1.0) * 0.99).max(0.0);
        for x in [-0.25, 0.25] {
            positions.extend([x, y, 0.0]);
            normals.extend([0.0, 0.0, 1.0]);
            joints.push([0, 1, 0, 0]);
            weights.extend([1.0 - share, share, 0.0, 0.0]);
        }
        if row > 0 {
            let first = 2 * row as u16 - 2;
            indices.extend([first, first + 1, first + 2, first + 1, first + 3, first + 2]);
        }
    }
    let binds = [DMat4::IDENTITY, DMat4::from_translation(DVec3::NEG_Y)];
    let binds: Vec<f32> = binds.iter().flat_map(|m| m.to_cols_array().map(|x| x as f32)).collect();
    let binds = maker.floats("MAT4", &binds);
    let primitive = json!({
        "attributes": {
            "POSITION": maker.floats("VEC3", &positions), "NORMAL": maker.floats("VEC3", &normals),
            "JOINTS_0": maker.joints(&joints), "WEIGHTS_0": maker.floats("VEC4", &weights),
        },
        "indices": maker.indices(&indices), "material": 0,
    });
    (json!({ "name": "strip", "primitives": [primitive] }), binds)
}

/// The triangle, flat-shaded, with two morph targets.
pub(super) fn triangle(maker: &mut Maker) -> Value {
    let positions = maker.floats("VEC3", &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let up = maker.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0]);
    let along = maker.floats("VEC3", &[0.5, 0.0, 0.0, 0.5, 0.0, 0.0, 0.25, 0.0, 0.25]);
    json!({
        "name": "triangle", "weights": [0.25, 0.0],
        "primitives": [{
            "attributes": { "POSITION": positions }, "material": 0,
            "targets": [{ "POSITION": up }, { "POSITION": along }],
        }],
    })
}

/// Strip, triangle and floor, with two animations: one with straight lines and steps, one of splines.
pub(super) fn scene() -> String {
    let mut maker = Maker::default();
    let (strip, binds) = strip(&mut maker);
    let triangle = triangle(&mut maker);
    let floor = maker.floats("VEC3", &[-3.0, 0.0, 3.0, 3.0, 0.0, 3.0, 3.0, 0.0, -3.0, -3.0, 0.0, -3.0]);
    let floor_indices = maker.indices(&[0, 1, 2, 0, 2, 3]);
    let floor = json!({ "primitives": [{ "attributes": { "POSITION": floor }, "indices": floor_indices, "material": 0 }] });
    let times = maker.floats("SCALAR", &[0.0, 0.5, 2.0]);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let turns = maker.floats("VEC4", &[0.0, 0.0, 0.0, 1.0, half, 0.0, 0.0, half, 0.0, 0.6, 0.0, -0.8]);
    let sizes = maker.floats("VEC3", &[1.0, 1.0, 1.0, 1.5, 0.5, 1.0, 1.0, 2.0, 0.5]);
    let places = maker.floats("VEC3", &[0.0, 0.0, 0.0, 0.0, 0.5, 0.25, 1.0, 0.0, 0.0]);
    let shares = maker.floats("SCALAR", &[0.0, 1.0, 1.0, 0.0, 0.5, 0.5]);
    let numbers =
        |count: usize| -> Vec<f32> { (0..count).map(|i| ((i * 37) % 11) as f32 / 11.0 - 0.4).collect() };
    let spline_turns = maker.floats("VEC4", &numbers(36));
    let spline_places = maker.floats("VEC3", &numbers(27));
    let spline_shares = maker.floats("SCALAR", &numbers(18));
    let channel = |sampler: usize, node: usize, path: &str| json!({ "sampler": sampler, "target": { "node": node, "path": path } });
    let sampler =
        |output: usize, kind: &str| json!({ "input": times, "output": output, "interpolation": kind });
    maker.finish(json!({
        "scene": 0,
        "scenes": [{ "nodes": [0, 5] }],
        "nodes": [
            { "name": "top", "children": [1, 2, 4], "translation": [10.0, 0.5, -7.0], "rotation": [0.0, 0.6, 0.0, 0.8] },
            { "name": "strip", "mesh": 0, "skin": 0, "translation": [9.0, 9.0, 9.0] },
            { "name": "hip", "children": [3], "scale": [1.5, 1.5, 1.5] },
            { "name": "knee", "translation": [0.0, 1.0, 0.0] },
            { "name": "triangle", "mesh": 1, "translation": [-1.0, 0.25, 1.0], "scale": [-1.0, 1.0, 2.0] },
            { "name": "floor", "mesh": 2, "translation": [10.0, 0.0, -7.0] },
        ],
        "skins": [{ "joints": [2, 3], "inverseBindMatrices": binds }],
        "meshes": [strip, triangle, floor],
        "materials": [{ "name": "cloth", "doubleSided": true }],
        "animations": [
            {
                "name": "walk",
                "samplers": [sampler(turns, "LINEAR"), sampler(sizes, "STEP"), sampler(places, "LINEAR"),
                             sampler(shares, "LINEAR")],
                "channels": [channel(0, 3, "rotation"), channel(1, 2, "scale"), channel(2, 0, "translation"),
                             channel(3, 4, "weights")],
            },
            {
                "samplers": [sampler(spline_turns, "CUBICSPLINE"), sampler(spline_places, "CUBICSPLINE"),
                             sampler(spline_shares, "CUBICSPLINE"), sampler(turns, "STEP")],
                "channels": [channel(0, 3, "rotation"), channel(1, 2, "translation"), channel(2, 4, "weights"),
                             channel(3, 0, "rotation")],
            },
        ],
    }))
}
