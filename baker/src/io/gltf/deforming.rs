//! Which meshes animations deform: those of skins with a joint that they move, and those with morph targets whose weights they
//! change.

use super::instances::NAME;
use super::node::{self, PlacedNode};
use super::notes::Told;
use super::rest::{AnimatedParts, parents};
use super::source::Source;
use crate::scene::SceneError;
use serde_json::Value;
use std::collections::BTreeSet;

/// Returns what animations change of the deformation of each node's mesh; `None` for a mesh that they do not deform.
///
/// # Errors
/// An extension that makes no sense.
pub(super) fn nodes(
    source: &Source,
    nodes: &[PlacedNode],
    told: &mut Told,
) -> Result<Vec<Option<AnimatedParts>>, SceneError> {
    let channels = || source.exact.animations.iter().flat_map(|animation| &animation.channels);
    let nodes_of = |wanted: &dyn Fn(&str) -> bool| -> BTreeSet<usize> {
        let targets = channels().map(|channel| &channel.target);
        targets.filter(|target| wanted(&target.path)).filter_map(|target| target.node).collect()
    };
    let moved = nodes_of(&|path| matches!(path, "translation" | "rotation" | "scale"));
    let weighted = nodes_of(&|path| path == "weights");
    if moved.is_empty() && weighted.is_empty() {
        return Ok(vec![None; nodes.len()]);
    }
    let parents = parents(source);
    // Nodes in a circle are refused when skins are read.
    let is_moved = |node: usize| {
        let above = |node: &usize| parents.get(*node).copied().flatten();
        std::iter::successors(Some(node), above).take(1 + parents.len()).any(|node| moved.contains(&node))
    };
    let mut out = Vec::with_capacity(nodes.len());
    for placed in nodes {
        let own = &source.root.nodes[placed.index];
        let mesh = own.mesh.and_then(|mesh| source.root.meshes.get(mesh.value()));
        let skin = own.skin.and_then(|skin| source.root.skins.get(skin.value()));
        let has_targets = mesh.is_some_and(|mesh| {
            mesh.primitives.iter().any(|primitive| primitive.targets.iter().flatten().next().is_some())
        });
        let weights = has_targets && weighted.contains(&placed.index);
        let joints = skin.is_some_and(|skin| skin.joints.iter().any(|joint| is_moved(joint.value())));
        let mut animated = (mesh.is_some() && (weights || joints)).then_some(AnimatedParts { weights });
        let instances: Option<Value> =
            source.read_extension(own, &[NAME], format_args!("node {}", placed.index))?;
        if animated.is_some() && skin.is_none() && instances.is_some() {
            let problem =
                "its instances stand still, as the file has them; an animation would change their shape";
            told.notes.push(format!("{}: {problem}", node::name(source, placed.index)));
            animated = None;
        }
        out.push(animated);
    }
    Ok(out)
}
