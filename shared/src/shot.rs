//! SHOT.json: one picture to take of a scene – size, camera and lights, in world space.
//!
//! ```json
//! { "size": [320, 180],
//!   "camera": { "position": [0, 1, 4], "target": [0, 1, 0], "up": [0, 1, 0], "yfov_deg": 60 },
//!   "lights": [ { "type": "spot", "position": [0, 2, 0], "direction": [0, -1, 0],
//!                 "outer_cone_deg": 40, "intensity": 60, "color": [1, 1, 1] } ] }
//! ```

use crate::{camera::Camera, light::Light};
use serde::{Deserialize, Serialize};

/// A picture to take.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shot {
    /// The scene's file, relative to the shot's; not used where a baked file is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene: Option<String>,
    /// Width and height in pixels.
    #[serde(default = "default_size")]
    pub size: [u32; 2],
    /// Where the picture is taken from.
    pub camera: Camera,
    /// What lights the scene; none at all is a black picture.
    #[serde(default)]
    pub lights: Vec<Light>,
}

fn default_size() -> [u32; 2] {
    [640, 360]
}
