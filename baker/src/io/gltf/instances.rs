//! Placements of a node's mesh: the node's transform, or the instances of EXT_mesh_gpu_instancing.

use super::node::{self, PlacedNode};
use super::pose::Pose;
use super::source::Source;
use crate::scene::SceneError;
use glam::DMat4;
use gltf::json::accessor::Type;
use serde::Deserialize;
use std::collections::BTreeMap;

/// Extension for instances.
pub(super) const NAME: &str = "EXT_mesh_gpu_instancing";

#[derive(Default, Deserialize)]
#[serde(default)]
struct Instances {
    attributes: BTreeMap<String, usize>,
}

/// The world-space transforms of a node's mesh.
pub(super) fn of(source: &Source, node: &PlacedNode) -> Result<Vec<DMat4>, SceneError> {
    let of = &source.root.nodes[node.index];
    let instances: Option<Instances> =
        source.read_extension(of, &[NAME], format_args!("node {}", node.index))?;
    let Some(instances) = instances else {
        return Ok(vec![node.world]);
    };
    let name = format!("the instances of {}", node::name(source, node.index));
    let attribute = |key: &str| instances.attributes.get(key).copied();
    let vectors = |key: &str| match attribute(key) {
        Some(a) => source.read::<3>(a, Type::Vec3, &format!("{key} of {name}")).map(Some),
        None => Ok(None),
    };
    let (translations, scales) = (vectors("TRANSLATION")?, vectors("SCALE")?);
    let rotations = match attribute("ROTATION") {
        Some(a) => Some(source.read::<4>(a, Type::Vec4, &format!("ROTATION of {name}"))?),
        None => None,
    };
    let counts = [
        translations.as_ref().map(Vec::len),
        rotations.as_ref().map(Vec::len),
        scales.as_ref().map(Vec::len),
    ];
    // Without the three attributes the instance count is unknown: a single instance at the node.
    let Some(count) = counts.into_iter().flatten().next() else {
        return Ok(vec![node.world]);
    };
    if counts.into_iter().flatten().any(|c| c != count) {
        return Err(source.malformed(format!("{name} have attributes of different lengths")));
    }
    let rest = Pose::default();
    let matrices = (0..count).map(|i| {
        let pose = Pose {
            translation: translations.as_ref().map_or(rest.translation, |t| t[i]),
            rotation: rotations.as_ref().map_or(rest.rotation, |r| r[i]),
            scale: scales.as_ref().map_or(rest.scale, |s| s[i]),
        };
        let world = node.world * pose.matrix();
        let problem = || source.malformed(format!("{name} have a transform that is not finite"));
        if world.is_finite() { Ok(world) } else { Err(problem()) }
    });
    matrices.collect()
}
