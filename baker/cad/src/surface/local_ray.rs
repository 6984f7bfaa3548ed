//! A ray in a surface's own coordinates.

use super::Ray;
use crate::frame::Frame;
use glam::DVec3;

/// Lengths of a direction whose squares neither overflow nor vanish.
const LENGTHS: std::ops::Range<f64> = 1e-100..1e100;

/// A ray in the coordinates of a frame, its origin moved to where it is nearest to a centre. From there all that concerns the
/// surface is of the surface's size, and a far origin takes no digits from the roots (Haines, Günther and Akenine-Möller,
/// "Precision improvements for ray/sphere intersection", Ray Tracing Gems, 2019).
#[derive(Clone, Copy, Debug)]
pub(crate) struct LocalRay {
    /// The place of the ray nearest to the centre.
    pub origin: DVec3,
    /// Unit vector.
    pub direction: DVec3,
    /// Length from the ray's own origin to `origin`, along the direction.
    moved: f64,
    /// Length of the ray's own direction.
    length: f64,
}

impl LocalRay {
    /// A line without a direction, which meets nothing.
    pub const NONE: Self = Self { origin: DVec3::ZERO, direction: DVec3::ZERO, moved: 0.0, length: 1.0 };

    /// `centre` is in local coordinates. `None` if the direction has no length, or anything is not finite.
    pub fn new(ray: &Ray, frame: &Frame, centre: DVec3) -> Option<Self> {
        let mut direction = frame.local_direction(ray.direction);
        let mut length = direction.length();
        if LENGTHS.contains(&length) {
            direction /= length;
        } else {
            let size = ray.direction.abs().max_element();
            let scaled = frame.local_direction(ray.direction / size);
            (direction, length) = (scaled.try_normalize()?, size * scaled.length());
        }
        let mut origin = frame.local(ray.origin) - centre;
        let mut moved = 0.0;
        // The second time takes off what rounding left the first time.
        for _ in 0..2 {
            let step = -origin.dot(direction);
            origin += step * direction;
            moved += step;
        }
        origin.is_finite().then(|| Self { origin: origin + centre, direction, moved, length })
    }

    /// The multiple of the ray's own direction as a length from the origin.
    pub fn length_at(&self, distance: f64) -> f64 {
        distance * self.length - self.moved
    }

    /// The place a length `s` from the origin.
    pub fn at(&self, s: f64) -> DVec3 {
        self.origin + s * self.direction
    }

    /// The length `s` as a multiple of the ray's own direction, from its own origin.
    pub fn distance(&self, s: f64) -> f64 {
        (self.moved + s) / self.length
    }
}
