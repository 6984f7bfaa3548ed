//! KHR_lights_punctual.
//!
//! Read from the raw extension: the crate's own types have 32-bit numbers, and lose the name of an unknown light type.

use serde::Deserialize;

/// Name of the extension.
pub(super) const NAME: &str = "KHR_lights_punctual";

/// A light of the file; placed by nodes.
#[derive(Debug, Deserialize)]
#[serde(default)]
pub(super) struct PunctualLight {
    pub name: Option<String>,
    #[serde(rename = "type")]
    pub kind: String,
    pub color: [f64; 3],
    /// Candela, of directional lights lux.
    pub intensity: f64,
    pub spot: Spot,
}

impl Default for PunctualLight {
    fn default() -> Self {
        Self { name: None, kind: String::new(), color: [1.0; 3], intensity: 1.0, spot: Spot::default() }
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

/// The file's lights.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Lights {
    pub lights: Vec<PunctualLight>,
}
