//! Sphere, in its own coordinates: σ(u, v) = R (cos v cos u, cos v sin u, sin v), v from −π/2 to π/2.

use super::angle::turn_about_axis;
use super::local_ray::LocalRay;
use super::polynomial::{Roots, quadratic};
use super::torus;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;

/// Point, σᵤ, σᵥ.
pub(super) fn derivatives(radius: f64, at: DVec2) -> [DVec3; 3] {
    let (sin_u, cos_u) = at.x.sine_cosine();
    let (sin_v, cos_v) = at.y.sine_cosine();
    let out = DVec3::new(cos_u, sin_u, 0.0);
    [
        radius * (cos_v * out + sin_v * DVec3::Z),
        radius * cos_v * DVec3::new(-sin_u, cos_u, 0.0),
        radius * (cos_v * DVec3::Z - sin_v * out),
    ]
}

/// Outward unit normal, also at the poles.
pub(super) fn normal(at: DVec2) -> DVec3 {
    derivatives(1.0, at)[0]
}

/// Parameters of the nearest point. On the axis u is that of `near`, at the centre v too.
pub(super) fn invert(radius: f64, place: DVec3, near: Option<DVec2>) -> DVec2 {
    let u = turn_about_axis(place, radius, near);
    let v = match near {
        Some(near) if place.length() <= 1e-12 * radius => near.y,
        _ => place.z.arc_tangent2(place.truncate().length()),
    };
    DVec2::new(u, v)
}

/// Where a line meets the sphere: half a chord to both sides of the place nearest to the centre.
pub(super) fn roots(radius: f64, ray: &LocalRay) -> Roots {
    let nearest = ray.origin.length();
    let b = ray.origin.dot(ray.direction);
    let discriminant = (radius - nearest) * (radius + nearest);
    quadratic(1.0, b, -discriminant, discriminant)
}

/// How far a patch reaches along a direction: a torus whose circle turns about its own diameter.
pub(super) fn extent(radius: f64, direction: DVec3, patch: [DVec2; 2]) -> [f64; 2] {
    torus::extent(0.0, radius, direction, patch)
}

/// Area of a patch.
pub(super) fn area(radius: f64, [low, high]: [DVec2; 2]) -> f64 {
    // sin b − sin a, without cancellation.
    let rise = 2.0 * (0.5 * (low.y + high.y)).cosine() * (0.5 * (high.y - low.y)).sine();
    radius * radius * (high.x - low.x) * rise.abs()
}
