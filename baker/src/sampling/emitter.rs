//! Particle emitter: start positions of importance particles, and views. [`locate`](super::locate) finds an emitter.

use crate::random::Stream;
use glam::Vec3;
use rebounce_shared::elementary::Elementary;

/// Assumed width of pictures over the height.
const WIDE: f32 = 1.5;

/// A view: position and direction of an observer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Position of the observer, local space.
    pub position: Vec3,
    /// Unit direction; zero for a view all around.
    pub towards: Vec3,
    /// Tangent of half the horizontal field of view.
    pub wide: f32,
}

impl View {
    /// View all around.
    pub fn around(position: Vec3) -> Self {
        Self { position, towards: Vec3::ZERO, wide: f32::INFINITY }
    }

    /// View of a camera at `position` with this vertical field of view, degrees.
    pub fn of_camera(position: Vec3, towards: Vec3, yfov_deg: f32) -> Self {
        let towards = towards.normalize_or_zero();
        Self { position, towards, wide: WIDE * (0.5 * yfov_deg).clamp(0.5, 80.0).to_radians().tangent() }
    }

    /// Random unit direction in the view.
    pub(super) fn direction(&self, stream: &mut Stream) -> Vec3 {
        if self.towards == Vec3::ZERO {
            return stream.sphere();
        }
        let (across, up) = self.towards.any_orthonormal_pair();
        let (sin, cos) = (std::f32::consts::TAU * stream.unit()).sine_cosine();
        (self.towards + (across * cos + up * sin) * (self.wide * stream.unit().sqrt())).normalize()
    }
}

/// Start positions of particles, and views.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ParticleEmitter {
    /// Viewpoints, local space; may be empty in an open scene.
    pub viewpoints: Vec<Vec3>,
    /// Views; empty if unknown.
    pub views: Vec<View>,
    /// True for an object or a landscape, where light arrives from all around and leaves; false for a room.
    pub is_open: bool,
    /// Whether surfaces of an open scene that face only the sky have points, too.
    pub faces_sky: bool,
}

impl ParticleEmitter {
    /// Emitter of a room with a single viewpoint, local space.
    pub fn within(viewpoint: Vec3) -> Self {
        Self { viewpoints: vec![viewpoint], ..Self::default() }
    }
}
