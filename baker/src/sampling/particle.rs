//! Rays of a particle: from a viewpoint, and after a diffuse bounce.

use crate::geometry::{Hit, Ray};
use crate::random::Stream;
use glam::Vec3;

/// Ray from a viewpoint in a random direction.
pub(super) fn from_viewpoint(viewpoint: Vec3, stream: &mut Stream) -> Ray {
    Ray::visibility(viewpoint, stream.sphere())
}

/// Cosine-distributed ray after a bounce at a hit; `None` if the direction around the shading normal points into the
/// surface.
pub(super) fn bounced(hit: &Hit, epsilon: f32, stream: &mut Stream) -> Option<Ray> {
    let direction = stream.cosine_hemisphere(hit.normal);
    let origin = hit.offset_origin(direction, epsilon);
    let ray = Ray::visibility(origin, direction);
    (direction.dot(hit.geometric_normal) > 0.0).then_some(ray)
}
