//! SHOT.json: description of a picture of a scene – size, camera and lights, in world space.
//!
//! ```json
//! { "size": [320, 180],
//!   "camera": { "position": [0, 1, 4], "target": [0, 1, 0], "up": [0, 1, 0], "yfov_deg": 60 },
//!   "lights": [ { "type": "spot", "position": [0, 2, 0], "direction": [0, -1, 0],
//!                 "outer_cone_deg": 40, "intensity": 60, "color": [1, 1, 1] } ] }
//! ```

use crate::{camera::Camera, light::Light};
use serde::{Deserialize, Serialize};

/// Picture to render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shot {
    /// File of the scene, relative to the shot's file; unused if a baked file is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// Width and height in pixels.
    #[serde(default = "default_size")]
    pub size: [u32; 2],
    /// Camera of the picture.
    pub camera: Camera,
    /// Lights of the scene; without lights the picture is black.
    #[serde(default)]
    pub lights: Vec<Light>,
}

fn default_size() -> [u32; 2] {
    [640, 360]
}
