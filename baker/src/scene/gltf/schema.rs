//! The parts of glTF 2.0's JSON that are used. Everything is optional here and
//! every index is checked where it is followed, so that a broken file ends in an error and never
//! in a panic.

mod geometry;
mod material;

pub(super) use geometry::*;
pub(super) use material::*;

use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Debug, Default, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Root {
    pub asset: Asset,
    pub scene: Option<usize>,
    pub scenes: Vec<SceneNodes>,
    pub nodes: Vec<Node>,
    pub meshes: Vec<Mesh>,
    pub accessors: Vec<Accessor>,
    pub buffer_views: Vec<BufferView>,
    pub buffers: Vec<Buffer>,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub images: Vec<Image>,
    pub samplers: Vec<Sampler>,
    pub cameras: Vec<Camera>,
    pub animations: Vec<Animation>,
    pub extensions_required: Vec<String>,
    pub extensions: RootExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Asset {
    pub version: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct RootExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub lights: PunctualLights,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct PunctualLights {
    pub lights: Vec<PunctualLight>,
}

#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct PunctualLight {
    #[serde(rename = "type")]
    pub kind: String,
    pub color: [f64; 3],
    pub intensity: f64,
    pub spot: Spot,
}

impl Default for PunctualLight {
    fn default() -> Self {
        Self { kind: String::new(), color: [1.0; 3], intensity: 1.0, spot: Spot::default() }
    }
}

#[derive(Debug, Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Spot {
    pub inner_cone_angle: f64,
    pub outer_cone_angle: f64,
}

impl Default for Spot {
    fn default() -> Self {
        Self { inner_cone_angle: 0.0, outer_cone_angle: std::f64::consts::FRAC_PI_4 }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct SceneNodes {
    pub nodes: Vec<usize>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Node {
    pub name: String,
    pub children: Vec<usize>,
    pub mesh: Option<usize>,
    pub camera: Option<usize>,
    pub matrix: Option<[f64; 16]>,
    pub translation: Option<[f64; 3]>,
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
    pub extensions: NodeExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub light: Option<NodeLight>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub instances: Option<Instances>,
    #[serde(rename = "KHR_node_visibility")]
    pub visibility: Visibility,
}

#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct Visibility {
    pub visible: bool,
}

impl Default for Visibility {
    fn default() -> Self {
        Self { visible: true }
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Instances {
    pub attributes: BTreeMap<String, usize>,
}

#[derive(Debug, Deserialize)]
pub(super) struct NodeLight {
    pub light: usize,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Camera {
    pub perspective: Option<Perspective>,
    pub orthographic: Option<Orthographic>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Perspective {
    pub yfov: f64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Orthographic {
    pub ymag: f64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Animation {
    pub name: String,
    pub channels: Vec<Channel>,
    pub samplers: Vec<AnimationSampler>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Channel {
    pub sampler: usize,
    pub target: Target,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Target {
    pub node: Option<usize>,
    pub path: String,
    pub extensions: TargetExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TargetExtensions {
    #[serde(rename = "KHR_animation_pointer")]
    pub pointer: Option<Pointer>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Pointer {
    pub pointer: String,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct AnimationSampler {
    pub input: usize,
    pub output: usize,
    pub interpolation: Option<String>,
}
