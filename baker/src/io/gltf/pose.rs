//! A node's own transform: translation, rotation, scale.

use glam::{DMat4, DQuat, DVec3};

/// Parts of a node's transform, animated separately.
#[derive(Clone, Copy)]
pub(super) struct Pose {
    pub translation: [f64; 3],
    pub rotation: [f64; 4],
    pub scale: [f64; 3],
}

impl Default for Pose {
    fn default() -> Self {
        Self { translation: [0.0; 3], rotation: [0.0, 0.0, 0.0, 1.0], scale: [1.0; 3] }
    }
}

impl Pose {
    pub fn matrix(&self) -> DMat4 {
        let rotation = DQuat::from_array(self.rotation);
        let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
        DMat4::from_scale_rotation_translation(
            DVec3::from(self.scale),
            rotation,
            DVec3::from(self.translation),
        )
    }
}
