//! Placement: an orthonormal, right-handed frame (`axis2_placement_3d`).

use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;

/// Origin and axes. Unit vectors at right angles, x × y = z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Location.
    pub origin: DVec3,
    /// Reference direction.
    pub x: DVec3,
    /// z × x.
    pub y: DVec3,
    /// Axis.
    pub z: DVec3,
}

impl Default for Frame {
    fn default() -> Self {
        Self { origin: DVec3::ZERO, x: DVec3::X, y: DVec3::Y, z: DVec3::Z }
    }
}

impl Frame {
    /// The frame with this axis; `reference` is made a right angle to it. `None` if either is zero or they are parallel.
    pub fn new(origin: DVec3, axis: DVec3, reference: DVec3) -> Option<Self> {
        let z = axis.try_normalize()?;
        let x = (reference - reference.dot(z) * z).try_normalize()?;
        Some(Self { origin, x, y: z.cross(x), z })
    }

    /// From local coordinates to space.
    pub fn place(&self, local: DVec3) -> DVec3 {
        self.origin + self.turn(local)
    }

    /// A local direction in space.
    pub fn turn(&self, local: DVec3) -> DVec3 {
        local.x * self.x + local.y * self.y + local.z * self.z
    }

    /// From space to local coordinates.
    pub fn local(&self, place: DVec3) -> DVec3 {
        self.local_direction(place - self.origin)
    }

    /// A direction of space in local coordinates.
    pub fn local_direction(&self, direction: DVec3) -> DVec3 {
        DVec3::new(direction.dot(self.x), direction.dot(self.y), direction.dot(self.z))
    }
}

/// Unit vector at an angle to the x axis, radians.
pub(crate) fn unit(angle: f64) -> DVec2 {
    let (sine, cosine) = angle.sine_cosine();
    DVec2::new(cosine, sine)
}
