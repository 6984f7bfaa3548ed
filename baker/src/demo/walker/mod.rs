//! A walking figure as a .glb file: a mannequin of capsules, skinned to eleven joints, with a walk cycle.
//!
//! It stands at the origin, faces +z and walks along it; animation `walk`, [`SECONDS`] long.
//!
//! * here: bones, skin, walk; `file` – the container.

mod file;

use file::{Chunk, container};
use glam::DVec3;
use rebounce_shared::elementary::Elementary;
use serde_json::{Value, json};
use std::f64::consts::{PI, TAU};

/// Length of the animation.
pub const SECONDS: f64 = CYCLE * CYCLES as f64;
/// Metres a second.
pub const SPEED: f64 = 1.2;
/// Seconds of two steps.
const CYCLE: f64 = 1.2;
const CYCLES: usize = 3;
/// Keys of a cycle.
const KEYS: usize = 16;
/// Vertices around a limb, and along each half of one.
const AROUND: usize = 16;
const ALONG: usize = 10;
/// Share of a limb over which the skin goes over to the joint above.
const BLEND: f64 = 0.2;

/// A bone: a capsule from its joint.
struct Bone {
    name: &'static str,
    /// Bone that it hangs from.
    parent: Option<usize>,
    /// Its joint at rest, metres.
    joint: DVec3,
    /// End of the capsule at rest.
    end: DVec3,
    /// Radius at the joint and at the end.
    radius: [f64; 2],
    material: usize,
}

/// Materials: coat, trousers, skin.
const COLOURS: [[f64; 3]; 3] = [[0.75, 0.1, 0.06], [0.1, 0.16, 0.5], [0.7, 0.45, 0.32]];

fn bones() -> Vec<Bone> {
    let at = DVec3::new;
    let bone =
        |name, parent, joint, end, radius, material| Bone { name, parent, joint, end, radius, material };
    let mut out = vec![
        bone("hips", None, at(0.0, 0.95, 0.0), at(0.0, 1.02, 0.0), [0.15, 0.14], 1),
        bone("spine", Some(0), at(0.0, 1.05, 0.0), at(0.0, 1.4, 0.0), [0.14, 0.17], 0),
        bone("head", Some(1), at(0.0, 1.56, 0.0), at(0.0, 1.66, 0.02), [0.08, 0.1], 2),
    ];
    for (side, names) in [
        (1.0, ["left arm", "left forearm", "left thigh", "left shin"]),
        (-1.0, ["right arm", "right forearm", "right thigh", "right shin"]),
    ] {
        let [shoulder, elbow, wrist] = [at(0.22, 1.42, 0.0), at(0.25, 1.14, 0.0), at(0.26, 0.9, 0.03)];
        let [hip, knee, foot] = [at(0.1, 0.92, 0.0), at(0.1, 0.5, 0.0), at(0.1, 0.08, 0.0)];
        let mirrored = |place: DVec3| at(side * place.x, place.y, place.z);
        let first = out.len();
        let limb = [
            (Some(1), shoulder, elbow, [0.06, 0.05], 0),
            (Some(first), elbow, wrist, [0.05, 0.04], 0),
            (Some(0), hip, knee, [0.09, 0.065], 1),
            (Some(first + 2), knee, foot, [0.065, 0.05], 1),
        ];
        for (name, (parent, joint, end, radius, material)) in names.into_iter().zip(limb) {
            out.push(bone(name, parent, mirrored(joint), mirrored(end), radius, material));
        }
    }
    out
}

/// Turn of a bone about x at a phase of the cycle, 0 to 1, radians; positive swings it back.
fn turn(bone: &Bone, phase: f64) -> f64 {
    let is_left = bone.name.starts_with("left");
    let swing = (TAU * (phase + if is_left { 0.0 } else { 0.5 })).sine();
    let lift = (TAU * (phase + if is_left { 0.2 } else { 0.7 })).sine().max(0.0);
    match bone.name.rsplit(' ').next() {
        Some("thigh") => -0.45 * swing,
        Some("shin") => 0.15 + 0.85 * lift,
        Some("arm") => 0.4 * swing,
        Some("forearm") => -0.35 + 0.15 * swing,
        Some("spine") => 0.05,
        _ => 0.0,
    }
}

/// Vertices of a primitive.
#[derive(Default)]
struct Skinned {
    positions: Vec<f32>,
    normals: Vec<f32>,
    joints: Vec<u8>,
    weights: Vec<f32>,
    indices: Vec<u32>,
}

impl Skinned {
    /// Adds the capsule of a bone.
    fn capsule(&mut self, bones: &[Bone], number: usize) {
        let bone = &bones[number];
        let axis = bone.end - bone.joint;
        let along = axis.normalize();
        let first = along.any_orthonormal_vector();
        let second = along.cross(first);
        let base = (self.positions.len() / 3) as u32;
        let rows = 2 * ALONG;
        for row in 0..=rows {
            // A half sphere at each end.
            let angle = PI * row as f64 / rows as f64;
            let is_end = 2 * row > rows;
            let radius = bone.radius[usize::from(is_end)];
            let middle = if is_end { bone.end } else { bone.joint };
            for column in 0..=AROUND {
                let (sine, cosine) = (TAU * column as f64 / AROUND as f64).sine_cosine();
                let normal = angle.sine() * (cosine * first + sine * second) - angle.cosine() * along;
                let place = middle + radius * normal;
                self.positions.extend(place.as_vec3().to_array());
                self.normals.extend(normal.as_vec3().to_array());
                let share = ((place - bone.joint).dot(along) / axis.length() / BLEND).clamp(-1.0, 1.0);
                let own = if bone.parent.is_some() { 0.5 + 0.5 * share } else { 1.0 };
                self.joints.extend([number as u8, bone.parent.unwrap_or(number) as u8, 0, 0]);
                self.weights.extend([own as f32, 1.0 - own as f32, 0.0, 0.0]);
            }
        }
        let width = AROUND as u32 + 1;
        for row in 0..rows as u32 {
            for column in 0..AROUND as u32 {
                let a = base + row * width + column;
                let [b, c, d] = [a + 1, a + width + 1, a + width];
                self.indices.extend([a, b, c, a, c, d]);
            }
        }
    }
}

/// The file.
pub fn glb() -> Vec<u8> {
    let bones = bones();
    let mut chunk = Chunk::default();
    let primitives: Vec<Value> = (0..COLOURS.len())
        .map(|material| {
            let mut mesh = Skinned::default();
            for number in (0..bones.len()).filter(|number| bones[*number].material == material) {
                mesh.capsule(&bones, number);
            }
            let count = mesh.positions.len() / 3;
            let position = chunk.floats(&mesh.positions, "VEC3", 3);
            let normal = chunk.floats(&mesh.normals, "VEC3", 3);
            let joints = chunk.add(&mesh.joints, 5121, "VEC4", count, None);
            let weights = chunk.floats(&mesh.weights, "VEC4", 4);
            let indices = chunk.add(bytemuck::cast_slice(&mesh.indices), 5125, "SCALAR", mesh.indices.len(), None);
            json!({
                "attributes": {"POSITION": position, "NORMAL": normal, "JOINTS_0": joints, "WEIGHTS_0": weights},
                "indices": indices,
                "material": material,
            })
        })
        .collect();
    // World from joint space is a shift at rest.
    let binds: Vec<f32> = bones
        .iter()
        .flat_map(|bone| {
            let [x, y, z] = (-bone.joint).as_vec3().to_array();
            [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0]
        })
        .collect();
    let binds = chunk.floats(&binds, "MAT4", 16);
    let (channels, samplers) = walk(&bones, &mut chunk);
    let node = |(number, bone): (usize, &Bone)| {
        let place = bone.joint - bone.parent.map_or(DVec3::ZERO, |parent| bones[parent].joint);
        let children: Vec<usize> =
            (0..bones.len()).filter(|child| bones[*child].parent == Some(number)).collect();
        let mut node = json!({"name": bone.name, "translation": place.to_array()});
        if !children.is_empty() {
            node["children"] = json!(children);
        }
        node
    };
    let mut nodes: Vec<Value> = bones.iter().enumerate().map(node).collect();
    nodes.push(json!({"name": "figure", "mesh": 0, "skin": 0}));
    let material = |[red, green, blue]: [f64; 3]| json!({"pbrMetallicRoughness": {"baseColorFactor": [red, green, blue, 1.0], "metallicFactor": 0.0}});
    let root = json!({
        "asset": {"version": "2.0", "generator": "Rebounce"},
        "scene": 0,
        "scenes": [{"nodes": [0, bones.len()]}],
        "nodes": nodes,
        "meshes": [{"name": "figure", "primitives": primitives}],
        "materials": COLOURS.map(material),
        "skins": [{"joints": (0..bones.len()).collect::<Vec<_>>(), "inverseBindMatrices": binds}],
        "animations": [{"name": "walk", "channels": channels, "samplers": samplers}],
        "accessors": chunk.accessors,
        "bufferViews": chunk.views,
        "buffers": [{"byteLength": chunk.bytes.len()}],
    });
    container(root.to_string().into_bytes(), chunk.bytes)
}

/// Channels and samplers of the walk cycle.
fn walk(bones: &[Bone], chunk: &mut Chunk) -> (Vec<Value>, Vec<Value>) {
    let count = KEYS * CYCLES + 1;
    let times: Vec<f64> = (0..count).map(|key| CYCLE * key as f64 / KEYS as f64).collect();
    let phase = |time: &f64| (time / CYCLE).fract();
    let numbers: Vec<f32> = times.iter().map(|time| *time as f32).collect();
    let input = chunk.floats(&numbers, "SCALAR", 1);
    let (mut channels, mut samplers) = (Vec::new(), Vec::new());
    let mut push = |node: usize, path: &str, output: usize| {
        channels.push(json!({"sampler": samplers.len(), "target": {"node": node, "path": path}}));
        samplers.push(json!({"input": input, "output": output, "interpolation": "LINEAR"}));
    };
    // Highest where the legs pass each other.
    let place = |time: &f64| {
        let bob = 0.02 * (2.0 * TAU * phase(time)).cosine();
        (bones[0].joint + DVec3::new(0.0, bob - 0.03, SPEED * time)).as_vec3().to_array()
    };
    let places: Vec<f32> = times.iter().flat_map(place).collect();
    push(0, "translation", chunk.floats(&places, "VEC3", 3));
    for (number, bone) in bones.iter().enumerate() {
        let turned = |time: &f64| {
            let (sine, cosine) = (0.5 * turn(bone, phase(time))).sine_cosine();
            [sine as f32, 0.0, 0.0, cosine as f32]
        };
        let turns: Vec<f32> = times.iter().flat_map(turned).collect();
        push(number, "rotation", chunk.floats(&turns, "VEC4", 4));
    }
    (channels, samplers)
}
