//! The node tree: transforms, cameras.

use super::exact::Transform;
use super::source::Source;
use crate::scene::SceneError;
use glam::{DMat4, DVec3};
use gltf::json::{Index, Node};
use rebounce_shared::camera::Camera;
use rebounce_shared::elementary::Elementary;
use serde::Deserialize;

/// A node of the scene with its transform to world space.
pub(super) struct PlacedNode {
    pub index: usize,
    /// Index of the parent in the list.
    pub parent: Option<usize>,
    pub world: DMat4,
}

/// All visible nodes at and below `roots`, parents before children.
pub(super) fn flatten(source: &Source, roots: Vec<usize>) -> Result<Vec<PlacedNode>, SceneError> {
    let root = &source.root;
    let mut seen = vec![false; root.nodes.len()];
    let mut out: Vec<PlacedNode> = Vec::new();
    let mut stack: Vec<(usize, Option<usize>)> = roots.into_iter().rev().map(|i| (i, None)).collect();
    while let Some((index, parent)) = stack.pop() {
        let node =
            root.nodes.get(index).ok_or_else(|| source.malformed(format!("there is no node {index}")))?;
        if std::mem::replace(&mut seen[index], true) {
            let problem = format!("{} has two parents or is its own ancestor", name(source, index));
            return Err(source.malformed(problem));
        }
        let visibility: Option<Visibility> =
            source.read_extension(node, &["KHR_node_visibility"], format_args!("node {index}"))?;
        if visibility.is_some_and(|v| !v.visible) {
            continue;
        }
        let local = source.exact.nodes.get(index).map_or(DMat4::IDENTITY, Transform::local);
        let world = parent.map_or(DMat4::IDENTITY, |p: usize| out[p].world) * local;
        if !world.is_finite() {
            let problem = format!("{} has a transform that is not finite", name(source, index));
            return Err(source.malformed(problem));
        }
        let place = Some(out.len());
        stack.extend(children(node).rev().map(|child| (child, place)));
        out.push(PlacedNode { index, parent, world });
    }
    Ok(out)
}

/// Name of a node in errors.
pub(super) fn name(source: &Source, index: usize) -> String {
    let name = source.root.nodes.get(index).and_then(|node| node.name.as_deref());
    format!("node {index} ({:?})", name.unwrap_or_default())
}

/// Returns `name`, or the node's name if `name` is empty.
pub(super) fn or_of_node(source: &Source, node: &PlacedNode, name: String) -> String {
    if name.is_empty() { source.root.nodes[node.index].name.clone().unwrap_or_default() } else { name }
}

/// Name of a node's camera, or else of the node.
pub(super) fn camera_name(source: &Source, node: &PlacedNode) -> String {
    let camera =
        source.root.nodes[node.index].camera.and_then(|index| source.root.cameras.get(index.value()));
    or_of_node(source, node, camera.and_then(|camera| camera.name.clone()).unwrap_or_default())
}

fn children(node: &Node) -> impl DoubleEndedIterator<Item = usize> {
    node.children.iter().flatten().map(Index::value)
}

/// KHR_node_visibility.
#[derive(Deserialize)]
#[serde(default)]
struct Visibility {
    visible: bool,
}

impl Default for Visibility {
    fn default() -> Self {
        Self { visible: true }
    }
}

/// Position and direction of a light or camera with the transform `world`.
pub(super) fn placement(world: &DMat4) -> ([f64; 3], [f64; 3]) {
    let direction = (-world.z_axis.truncate()).try_normalize().unwrap_or(DVec3::NEG_Z);
    (world.w_axis.truncate().to_array(), direction.to_array())
}

/// Converts the node's camera. `size` is the diagonal of the scene's main part. The target is the point of the view
/// axis beside `origin`, the middle of the main part, and at least 0.05 `size` ahead. An orthographic camera becomes a
/// perspective camera with equal view height at the target.
pub(super) fn camera(
    source: &Source,
    node: &PlacedNode,
    origin: [f64; 3],
    size: f64,
) -> Result<Option<Camera>, SceneError> {
    let Some(index) = source.root.nodes[node.index].camera else {
        return Ok(None);
    };
    let index = index.value();
    let camera = source.exact.cameras.get(index);
    let camera = camera.ok_or_else(|| source.malformed(format!("there is no camera {index}")))?;
    let position = node.world.w_axis.truncate();
    let forward = (-node.world.z_axis.truncate()).try_normalize().unwrap_or(DVec3::NEG_Z);
    let up = node.world.y_axis.truncate().try_normalize().unwrap_or(DVec3::Y);
    let distance = forward.dot(DVec3::from(origin) - position).max(0.05 * size);
    let yfov = match (&camera.perspective, &camera.orthographic) {
        (Some(perspective), _) => perspective.yfov,
        (None, Some(orthographic)) => 2.0 * (orthographic.ymag.abs() / distance).arc_tangent(),
        (None, None) => return Err(source.malformed(format!("camera {index} is of no known type"))),
    };
    let camera = Camera {
        position: position.to_array(),
        target: (position + forward * distance).to_array(),
        up: up.to_array(),
        yfov_deg: yfov.to_degrees().clamp(1.0, 170.0),
    };
    if camera.is_usable() {
        return Ok(Some(camera));
    }
    let problem = "has a place or field of view that is not finite, or far too large";
    Err(source.malformed(format!("camera {index} {problem}")))
}
