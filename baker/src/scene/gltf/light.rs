//! KHR_lights_punctual.
//!
//! Read from the raw extension: in the crate's own form of it numbers have 32 bits and types that it does not know have
//! no name.

use super::node::{Placed, placement};
use super::source::Source;
use crate::scene::SceneError;
use rebounce_shared::light::Light;
use serde::Deserialize;

const NAME: &str = "KHR_lights_punctual";

/// A light as the file has it; nodes place it.
#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct PunctualLight {
    #[serde(rename = "type")]
    pub kind: String,
    pub color: [f64; 3],
    /// Candela, of directional lights lux.
    pub intensity: f64,
    pub spot: Spot,
}

impl Default for PunctualLight {
    fn default() -> Self {
        Self { kind: String::new(), color: [1.0; 3], intensity: 1.0, spot: Spot::default() }
    }
}

/// Angles between a spot's axis and the edges of its cones, radians.
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
struct Lights {
    lights: Vec<PunctualLight>,
}

#[derive(Debug, Deserialize)]
struct NodeLight {
    light: usize,
}

/// The file's lights.
pub(super) fn all(source: &Source) -> Result<Vec<PunctualLight>, SceneError> {
    let lights: Option<Lights> = source.read_extension(&source.root, &[NAME], "the file")?;
    Ok(lights.unwrap_or_default().lights)
}

/// Which light a node places.
pub(super) fn index(source: &Source, node: usize) -> Result<Option<usize>, SceneError> {
    let light: Option<NodeLight> =
        source.read_extension(&source.root.nodes[node], &[NAME], format_args!("node {node}"))?;
    Ok(light.map(|light| light.light))
}

/// The node's KHR_lights_punctual light.
pub(super) fn of(source: &Source, node: &Placed) -> Result<Option<Light>, SceneError> {
    let Some(index) = index(source, node.index)? else {
        return Ok(None);
    };
    let light =
        source.lights.get(index).ok_or_else(|| source.malformed(format!("there is no light {index}")))?;
    let (position, direction) = placement(&node.world);
    let (color, intensity) = (light.color, light.intensity);
    let light = match light.kind.as_str() {
        "point" => Light::Point { position, intensity, color },
        "directional" => Light::Directional { direction, intensity, color },
        "spot" => Light::Spot {
            position,
            direction,
            outer_cone_deg: light.spot.outer_cone_angle.to_degrees(),
            inner_cone_deg: Some(light.spot.inner_cone_angle.to_degrees()),
            intensity,
            color,
        },
        other => {
            let problem = format!("light {index} is of the unknown type {other:?}");
            return Err(source.malformed(problem));
        }
    };
    if light.is_usable() {
        return Ok(Some(light));
    }
    let problem = "has a place, cone or intensity that is not finite, or far too large";
    Err(source.malformed(format!("light {index} {problem}")))
}
