//! Particle emitter: where importance particles start, and what is looked at. [`locate`](super::locate) finds one.

use crate::random::Stream;
use glam::Vec3;

/// Pictures are about so many times as wide as high.
const WIDE: f32 = 1.5;

/// From where somebody looks, and where to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// From there, local space.
    pub position: Vec3,
    /// Unit direction; zero for all around.
    pub towards: Vec3,
    /// Tangent of half the angle that is looked at.
    pub wide: f32,
}

impl View {
    /// All around.
    pub fn around(position: Vec3) -> Self {
        Self { position, towards: Vec3::ZERO, wide: f32::INFINITY }
    }

    /// What a camera at `position` sees that has this vertical field of view, degrees.
    pub fn of_camera(position: Vec3, towards: Vec3, yfov_deg: f32) -> Self {
        let towards = towards.normalize_or_zero();
        Self { position, towards, wide: WIDE * (0.5 * yfov_deg).clamp(0.5, 80.0).to_radians().tan() }
    }

    /// A unit direction that is looked in.
    pub(super) fn direction(&self, stream: &mut Stream) -> Vec3 {
        if self.towards == Vec3::ZERO {
            return stream.sphere();
        }
        let (across, up) = self.towards.any_orthonormal_pair();
        let (sin, cos) = (std::f32::consts::TAU * stream.unit()).sin_cos();
        (self.towards + (across * cos + up * sin) * (self.wide * stream.unit().sqrt())).normalize()
    }
}

/// Where particles start, and what is looked at.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleEmitter {
    /// Viewpoints, local space; of an open scene there may be none.
    pub viewpoints: Vec<Vec3>,
    /// What is looked at; none where nobody says.
    pub views: Vec<View>,
    /// Whether the scene is an object or a landscape, that light reaches from all around and leaves: no room.
    pub is_open: bool,
}

impl ParticleEmitter {
    /// In a room, local space.
    pub fn within(viewpoint: Vec3) -> Self {
        Self { viewpoints: vec![viewpoint], ..Self::default() }
    }
}
