//! A particle's rays: from a viewpoint, and on from a diffuse bounce.

use crate::geometry::{Hit, Ray};
use crate::random::Stream;
use glam::Vec3;

/// A ray from a viewpoint, in any direction.
pub(super) fn from_viewpoint(viewpoint: Vec3, stream: &mut Stream) -> Ray {
    Ray::visibility(viewpoint, stream.sphere())
}

/// The ray that goes on from where one ended, by the cosine; `None` where the shading normal allows a direction that
/// points into the surface.
pub(super) fn bounced(hit: &Hit, epsilon: f32, stream: &mut Stream) -> Option<Ray> {
    let direction = stream.cosine_hemisphere(hit.normal);
    let origin = hit.offset_origin(direction, epsilon);
    let ray = Ray::visibility(origin, direction);
    (direction.dot(hit.geometric_normal) > 0.0).then_some(ray)
}
