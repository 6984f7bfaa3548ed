//! EXT_lights_area: rectangles and disks placed by nodes. A draft, as Babylon.js reads it.

use super::node::{self, PlacedNode, placement};
use super::notes::Told;
use super::source::Source;
use crate::scene::SceneError;
use glam::DVec3;
use rebounce_shared::light::Light;
use serde::Deserialize;

/// Name of the extension.
const NAME: &str = "EXT_lights_area";

/// A light of the file.
#[derive(Debug, Deserialize)]
#[serde(default)]
struct AreaLight {
    name: String,
    #[serde(rename = "type")]
    kind: String,
    color: [f64; 3],
    /// Nits.
    intensity: f64,
    /// Height of a rectangle, diameter of a disk; of a node without scale.
    size: f64,
    rect: Rect,
}

impl Default for AreaLight {
    fn default() -> Self {
        Self {
            name: String::new(),
            kind: "rect".to_owned(),
            color: [1.0; 3],
            intensity: 1000.0,
            size: 1.0,
            rect: Rect::default(),
        }
    }
}

/// Shape of a rectangle.
#[derive(Debug, Deserialize)]
#[serde(default)]
struct Rect {
    /// Width over height.
    aspect: f64,
}

impl Default for Rect {
    fn default() -> Self {
        Self { aspect: 1.0 }
    }
}

/// The file's lights.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
struct AreaLights {
    lights: Vec<AreaLight>,
}

/// Light of a node.
#[derive(Debug, Deserialize)]
struct NodeAreaLight {
    light: usize,
}

/// A light placed by a node.
pub(super) struct PlacedAreaLight {
    /// Index into the nodes.
    pub place: usize,
    pub light: Light,
    /// Name of the light, or else of the node; may be empty.
    pub name: String,
}

/// Returns the placed lights in the order of `nodes`. A light that is none is left out, with a message; a negative
/// intensity or colour counts as 0, with a note.
pub(super) fn placed(
    source: &Source,
    nodes: &[PlacedNode],
    told: &mut Told,
) -> Result<Vec<PlacedAreaLight>, SceneError> {
    let lights: Option<AreaLights> = source.read_extension(&source.root, &[NAME], "the file")?;
    let lights = lights.unwrap_or_default().lights;
    let mut out = Vec::new();
    for (place, node) in nodes.iter().enumerate() {
        let what = format_args!("node {}", node.index);
        let own: Option<NodeAreaLight> =
            source.read_extension(&source.root.nodes[node.index], &[NAME], what)?;
        let Some(NodeAreaLight { light: index }) = own else { continue };
        let light = lights.get(index);
        let light = light.ok_or_else(|| source.malformed(format!("there is no area light {index}")))?;
        let what = format!("area light {index} ({:?})", light.name);
        match converted(light, node) {
            Ok((light, is_negative)) => {
                if is_negative {
                    told.notes.push(format!(
                        "{what}: its intensity or colour is negative, which no lamp is; it counts as 0"
                    ));
                }
                let name = node::or_of_node(source, node, lights[index].name.clone());
                out.push(PlacedAreaLight { place, light, name });
            }
            Err(problem) => told.left_out.push(format!("{what}: {problem}")),
        }
    }
    Ok(out)
}

/// Converts a light, and tells whether its intensity or colour was negative.
fn converted(light: &AreaLight, node: &PlacedNode) -> Result<(Light, bool), String> {
    let world = &node.world;
    let (position, direction) = placement(world);
    let axes = [world.x_axis, world.y_axis, world.z_axis];
    let scale = axes.into_iter().map(|axis| axis.truncate().length()).fold(0.0, f64::max);
    let size = light.size * scale;
    let is_negative = light.intensity < 0.0 || light.color.iter().any(|c| *c < 0.0);
    let (color, intensity) = (light.color.map(|c| c.max(0.0)), light.intensity.max(0.0));
    // A colour over 1 is brightness.
    let most = color.into_iter().fold(1.0, f64::max);
    let (color, intensity) = (color.map(|c| c / most), intensity * most);
    let light = match light.kind.as_str() {
        "rect" => Light::Rectangle {
            position,
            direction,
            up: world.y_axis.truncate().try_normalize().unwrap_or(DVec3::Y).to_array(),
            width: size * light.rect.aspect,
            height: size,
            intensity,
            color,
        },
        "disk" => Light::Disk { position, direction, radius: 0.5 * size, intensity, color },
        kind => return Err(format!("it is of the type {kind:?}: area lights are rect or disk")),
    };
    if !light.is_usable() || light.problem().is_some() {
        return Err("its size, place or intensity is no number above 0, or far too large".to_owned());
    }
    Ok((light, is_negative))
}
