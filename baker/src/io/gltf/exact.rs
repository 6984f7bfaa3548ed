//! Values that the `gltf` crate's document rounds or cannot hold, read from the same JSON: transforms and fields of
//! view in 64 bits, and animation targets.

use super::pose::Pose;
use glam::DMat4;
use serde::Deserialize;

/// Parts of the document, in file order.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Exact {
    pub nodes: Vec<Transform>,
    pub cameras: Vec<Camera>,
    pub animations: Vec<Animation>,
}

/// A node's transform: a matrix, or translation, rotation and scale; and its extras.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Transform {
    /// Whatever the file's maker has put there.
    pub extras: serde_json::Value,
    pub matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

impl Transform {
    /// Translation, rotation and scale, with defaults for absent parts.
    pub fn pose(&self) -> Pose {
        let rest = Pose::default();
        Pose {
            translation: self.translation.unwrap_or(rest.translation),
            rotation: self.rotation.unwrap_or(rest.rotation),
            scale: self.scale.unwrap_or(rest.scale),
        }
    }

    /// Replaces the transform.
    pub fn set_pose(&mut self, Pose { translation, rotation, scale }: Pose) {
        self.matrix = None;
        (self.translation, self.rotation, self.scale) = (Some(translation), Some(rotation), Some(scale));
    }

    /// Matrix from node space to parent space.
    pub fn local(&self) -> DMat4 {
        self.matrix.map_or_else(|| self.pose().matrix(), |m| DMat4::from_cols_array(&m))
    }
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Camera {
    pub perspective: Option<Perspective>,
    pub orthographic: Option<Orthographic>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Perspective {
    /// Radians.
    pub yfov: f64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Orthographic {
    /// Half the height of the view, scene units.
    pub ymag: f64,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Animation {
    pub channels: Vec<Channel>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Channel {
    pub target: Target,
}

/// Target of a channel: a part of a node's transform, or the property named by a pointer.
#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Target {
    pub node: Option<usize>,
    pub path: String,
    pub extensions: TargetExtensions,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct TargetExtensions {
    #[serde(rename = "KHR_animation_pointer")]
    pub pointer: Option<Pointer>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Pointer {
    pub pointer: String,
}
