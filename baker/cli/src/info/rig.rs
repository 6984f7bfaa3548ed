//! What animations deform, as text and as JSON.

use rebounce_shared::rig::{Rig, RigAnimation};
use serde_json::{Value, json};

/// Meshes and animations; null without.
pub(super) fn as_json(rig: &Rig) -> Value {
    if rig.is_empty() {
        return Value::Null;
    }
    json!({
        "vertices": rig.vertices.len(),
        "points": rig.points.len(),
        "nodes": rig.layout.nodes.len(),
        "bounds": rig.layout.bounds,
        "meshes": rig.layout.meshes.iter().map(|mesh| json!({
            "vertices": mesh.vertex_count, "joints": mesh.joints.len(), "morph_targets": mesh.weights.len(),
        })).collect::<Vec<_>>(),
        "animations": rig.layout.animations.iter().map(|animation| json!({
            "name": animation.name, "seconds": animation.duration, "tracks": animation.tracks.len(),
        })).collect::<Vec<_>>(),
    })
}

/// Lines about meshes and animations; none without.
pub(super) fn as_text(rig: &Rig) -> Vec<String> {
    if rig.is_empty() {
        return Vec::new();
    }
    let meshes = &rig.layout.meshes;
    let joints: usize = meshes.iter().map(|mesh| mesh.joints.len()).sum();
    let targets: usize = meshes.iter().map(|mesh| mesh.weights.len()).sum();
    let first = format!(
        "{} meshes, {} vertices, {joints} joints, {targets} morph targets, {} points",
        meshes.len(),
        rig.vertices.len(),
        rig.points.len()
    );
    let animation = |RigAnimation { name, duration, tracks }: &RigAnimation| {
        format!("{name:?}, {duration} s, {} tracks", tracks.len())
    };
    std::iter::once(first).chain(rig.layout.animations.iter().map(animation)).collect()
}
