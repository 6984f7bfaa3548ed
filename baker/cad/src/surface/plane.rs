//! Plane, in its own coordinates: σ(u, v) = (u, v, 0).

use super::local_ray::LocalRay;
use super::polynomial::Roots;
use super::{Ray, SurfaceHit};
use crate::frame::Frame;
use glam::{DVec2, DVec3};

/// Point, σᵤ, σᵥ.
pub(super) fn derivatives(at: DVec2) -> [DVec3; 3] {
    [at.extend(0.0), DVec3::X, DVec3::Y]
}

/// Parameters of the nearest point.
pub(super) fn invert(place: DVec3) -> DVec2 {
    place.truncate()
}

/// Where a ray meets the plane; a ray in the plane or along it does not.
pub(super) fn roots(ray: &LocalRay) -> Roots {
    let mut roots = Roots::default();
    roots.push(-ray.origin.z / ray.direction.z);
    roots
}

/// As [`roots`], with parameters, and at less cost: a plane has no curvature that would need digits near a centre.
pub(crate) fn meet(frame: &Frame, ray: &Ray) -> Option<SurfaceHit> {
    let offset = frame.origin - ray.origin;
    let distance = offset.dot(frame.z) / ray.direction.dot(frame.z);
    let place = distance * ray.direction - offset;
    distance
        .is_finite()
        .then(|| SurfaceHit { distance, at: DVec2::new(place.dot(frame.x), place.dot(frame.y)) })
}

/// How far a patch reaches along a direction.
pub(super) fn extent(direction: DVec3, [low, high]: [DVec2; 2]) -> [f64; 2] {
    let [a, b] = [direction.x * low.x, direction.x * high.x];
    let [c, d] = [direction.y * low.y, direction.y * high.y];
    [a.min(b) + c.min(d), a.max(b) + c.max(d)]
}
