//! Cylinder, in its own coordinates: σ(u, v) = (R cos u, R sin u, v).

use super::angle::{sinusoid_range, turn_about_axis};
use super::cone;
use super::local_ray::LocalRay;
use super::polynomial::Roots;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;

/// Point, σᵤ, σᵥ.
pub(super) fn derivatives(radius: f64, at: DVec2) -> [DVec3; 3] {
    let (sin, cos) = at.x.sine_cosine();
    let out = DVec3::new(cos, sin, 0.0);
    [radius * out + at.y * DVec3::Z, radius * DVec3::new(-sin, cos, 0.0), DVec3::Z]
}

/// Parameters of the nearest point; on the axis u is that of `near`.
pub(super) fn invert(radius: f64, place: DVec3, near: Option<DVec2>) -> DVec2 {
    DVec2::new(turn_about_axis(place, radius, near), place.z)
}

/// Where a line meets the cylinder: a cone that does not widen.
pub(super) fn roots(radius: f64, ray: &LocalRay) -> Roots {
    cone::roots(radius, 0.0, ray)
}

/// How far a patch reaches along a direction.
pub(super) fn extent(radius: f64, direction: DVec3, [low, high]: [DVec2; 2]) -> [f64; 2] {
    let [least, greatest] = sinusoid_range(direction.x, direction.y, [low.x, high.x]);
    let [a, b] = [direction.z * low.y, direction.z * high.y];
    [radius * least + a.min(b), radius * greatest + a.max(b)]
}
