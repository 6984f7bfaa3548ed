//! Lights placed by nodes.

use super::node::{self, PlacedNode, placement};
use super::notes::Told;
use super::punctual::NAME;
use super::source::Source;
use crate::scene::SceneError;
use rebounce_shared::light::Light;
use serde::Deserialize;

#[derive(Debug, Deserialize)]
struct NodeLight {
    light: usize,
}

/// Index of the light placed by a node.
fn index(source: &Source, node: usize) -> Result<Option<usize>, SceneError> {
    let light: Option<NodeLight> =
        source.read_extension(&source.root.nodes[node], &[NAME], format_args!("node {node}"))?;
    Ok(light.map(|light| light.light))
}

/// Name of a light in errors.
pub(super) fn name(source: &Source, index: usize) -> String {
    let name = source.lights.get(index).and_then(|light| light.name.as_deref());
    format!("light {index} ({:?})", name.unwrap_or_default())
}

/// Name of a light, or else of the node that places the light; may be empty.
pub(super) fn own_name(source: &Source, node: &PlacedNode, index: usize) -> String {
    let own = source.lights.get(index).and_then(|light| light.name.clone()).unwrap_or_default();
    node::or_of_node(source, node, own)
}

/// Returns the placed lights in the order of `nodes`: index into `nodes`, and index of the light. Lights of unknown
/// type are left out, with a message.
pub(super) fn placed(
    source: &Source,
    nodes: &[PlacedNode],
    told: &mut Told,
) -> Result<Vec<(usize, usize)>, SceneError> {
    let mut out = Vec::new();
    for (place, node) in nodes.iter().enumerate() {
        let Some(index) = index(source, node.index)? else { continue };
        let light =
            source.lights.get(index).ok_or_else(|| source.malformed(format!("there is no light {index}")))?;
        if ["point", "directional", "spot"].contains(&light.kind.as_str()) {
            out.push((place, index));
        } else {
            let (name, kind) = (name(source, index), &light.kind);
            told.left_out.push(format!("{name} of the type {kind:?}: lights are point, spot or directional"));
        }
    }
    Ok(out)
}

/// Converts a light placed by a node. A negative intensity or colour counts as 0, with a note.
pub(super) fn of(
    source: &Source,
    node: &PlacedNode,
    index: usize,
    told: &mut Told,
) -> Result<Light, SceneError> {
    let light =
        source.lights.get(index).ok_or_else(|| source.malformed(format!("there is no light {index}")))?;
    if light.intensity < 0.0 || light.color.iter().any(|c| *c < 0.0) {
        let name = name(source, index);
        told.notes
            .push(format!("{name}: its intensity or colour is negative, which no lamp is; it counts as 0"));
    }
    let (color, intensity) = (light.color.map(|c| c.max(0.0)), light.intensity.max(0.0));
    let (position, direction) = placement(&node.world);
    let light = match light.kind.as_str() {
        "point" => Light::Point { position, intensity, color, radius: 0.0 },
        "directional" => Light::Directional { direction, intensity, color, radius_deg: 0.0 },
        _ => Light::Spot {
            position,
            direction,
            outer_cone_deg: light.spot.outer_cone_angle.to_degrees(),
            inner_cone_deg: Some(light.spot.inner_cone_angle.to_degrees()),
            intensity,
            color,
            radius: 0.0,
        },
    };
    if light.is_usable() {
        return Ok(light);
    }
    let problem = "has a place, cone or intensity that is not finite, or far too large";
    Err(source.malformed(format!("{} {problem}", name(source, index))))
}
