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

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::rig::{RigLayout, RigMesh, RigVertex};

    #[test]
    fn meshes_and_animations_are_told() {
        assert!(as_text(&Rig::default()).is_empty() && as_json(&Rig::default()).is_null());
        let mesh = RigMesh { vertex_count: 2, weights: vec![0.0; 3], ..RigMesh::default() };
        let animation = RigAnimation { name: "walk".to_owned(), duration: 1.25, tracks: Vec::new() };
        let layout = RigLayout { meshes: vec![mesh], animations: vec![animation], ..RigLayout::default() };
        let rig = Rig { layout, vertices: vec![RigVertex::default(); 2], ..Rig::default() };
        assert_eq!(
            as_text(&rig),
            ["1 meshes, 2 vertices, 0 joints, 3 morph targets, 0 points", "\"walk\", 1.25 s, 0 tracks"]
        );
        let json = as_json(&rig);
        assert_eq!(json["meshes"][0]["morph_targets"], 3);
        assert_eq!(json["animations"][0]["seconds"], 1.25);
    }
}
