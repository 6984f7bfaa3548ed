//! A pinhole camera.

use crate::elementary::Elementary;
use glam::{DVec3, Mat4, Vec3};
use serde::{Deserialize, Serialize};

/// A pinhole camera in world space, as SHOT.json writes it. Right-handed; glTF's axes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, bincode::Encode, bincode::Decode)]
pub struct Camera {
    /// Eye, world space.
    pub position: [f64; 3],
    /// A point looked at, world space; must differ from `position`.
    pub target: [f64; 3],
    /// Up direction of the picture; need not be perpendicular to the view.
    #[serde(default = "up")]
    pub up: [f64; 3],
    /// Vertical field of view, degrees, over 0 and under 180.
    #[serde(default = "yfov")]
    pub yfov_deg: f64,
}

fn up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

fn yfov() -> f64 {
    60.0
}

/// A camera's frame in scene-local space: local = world − the file's origin.
#[derive(Clone, Copy, Debug)]
pub struct CameraFrame {
    /// Eye, local space.
    pub eye: Vec3,
    /// Unit vector to the right of the picture.
    pub right: Vec3,
    /// Unit vector to the top of the picture.
    pub up: Vec3,
    /// Unit vector into the picture.
    pub forward: Vec3,
    /// Tangent of half the vertical field of view.
    pub tan_half_yfov: f32,
}

impl Camera {
    /// Returns true if the camera's numbers are finite, with positions under 1e15 units; the frame's numbers are then
    /// finite too.
    pub fn is_usable(&self) -> bool {
        let near = |v: &[f64; 3]| v.iter().all(|x| x.abs() < 1e15);
        near(&self.position) && near(&self.target) && near(&self.up) && self.yfov_deg.is_finite()
    }

    /// The frame in local space, where `origin` (world space) is zero. A degenerate `up` is
    /// replaced by another axis.
    pub fn frame(&self, origin: [f64; 3]) -> CameraFrame {
        let origin = DVec3::from(origin);
        let eye = DVec3::from(self.position) - origin;
        let to_target = DVec3::from(self.target) - DVec3::from(self.position);
        let forward = if to_target.length_squared() > 0.0 { to_target.normalize() } else { DVec3::NEG_Z };
        let mut right = forward.cross(DVec3::from(self.up));
        if right.length_squared() < 1e-12 {
            right = forward.cross(if forward.y.abs() < 0.9 { DVec3::Y } else { DVec3::X });
        }
        let right = right.normalize();
        CameraFrame {
            eye: eye.as_vec3(),
            right: right.as_vec3(),
            up: right.cross(forward).as_vec3(),
            forward: forward.as_vec3(),
            tan_half_yfov: (self.yfov_deg.clamp(0.1, 179.0).to_radians() * 0.5).tangent() as f32,
        }
    }
}

impl CameraFrame {
    /// The unit direction through a point of a `width` x `height` picture; `x` to the right and
    /// `y` down, in pixels, pixel centres at halves.
    #[inline]
    pub fn direction(&self, x: f32, y: f32, width: u32, height: u32) -> Vec3 {
        let scale = 2.0 * self.tan_half_yfov / height as f32;
        let dx = (x - 0.5 * width as f32) * scale;
        let dy = (0.5 * height as f32 - y) * scale;
        (self.forward + dx * self.right + dy * self.up).normalize()
    }

    /// `view_from_local`: right-handed, looking down −z.
    pub fn view_from_local(&self) -> Mat4 {
        glam::camera::rh::view::look_to_mat4(self.eye, self.forward, self.up)
    }
}
