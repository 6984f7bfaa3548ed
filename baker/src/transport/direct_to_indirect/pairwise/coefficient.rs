//! Coefficient of a link: the kernel of the transport operator between a receiver and a sender, averaged over ten rays.
//!
//! ```text
//! K_ij = 1/π ∫ B_j ρ V cos θ_i cos θ_y / |x_i − y|² dA_y  ≈  A_j / 10 · Σ_m a_j(ρ_m) V_m g(x_i, y_m)
//! g(x, y) = cos θ_x cos θ_y / (π |x − y|² + A_j / 10)
//! ```
//!
//! The denominator is that of a small disk seen from along its axis (Wallace, Elmquist and Haines 1989): the kernel stays
//! bounded where receiver and sender touch.

use super::hits::NearField;
use super::quadrature::{PLACES, Quadrature, SenderSample};
use crate::geometry::Surfaces;
use crate::sampling::SurfacePoint;
use glam::{Vec3, Vec3A};

/// A receiver as links see it.
#[derive(Clone, Copy, Debug)]
pub struct Viewpoint {
    /// Origin of its rays, local space.
    pub origin: Vec3,
    /// Shading normal.
    pub normal: Vec3,
    /// Normal of the true surface: what is below it is not seen.
    pub geometric_normal: Vec3,
}

impl Viewpoint {
    /// Creates the viewpoint of a point.
    pub fn of<S: Surfaces + ?Sized>(surfaces: &S, point: &SurfacePoint) -> Self {
        let epsilon = surfaces.epsilon_at(point.position);
        let origin = point.position + epsilon * point.geometric_normal;
        Self { origin, normal: point.normal, geometric_normal: point.geometric_normal }
    }

    /// g(x, y) of a place that stands for this `area`; 0 where one of them faces away.
    #[inline]
    pub fn form_factor(&self, position: Vec3, normal: Vec3, area: f32) -> f32 {
        let way = position - self.origin;
        let (here, there) = (way.dot(self.normal), -way.dot(normal));
        if here <= 0.0 || there <= 0.0 || way.dot(self.geometric_normal) <= 0.0 {
            return 0.0;
        }
        let squared = way.length_squared();
        here * there / (squared * (std::f32::consts::PI * squared + area))
    }
}

/// Coefficient of a receiver and a sender.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Coefficient {
    /// K: irradiance along the receiver's normal per unit irradiance at the sender.
    pub amount: f32,
    /// Part of it that finer senders do not cover: it stays when the sender is refined.
    pub kept: f32,
    /// Standard deviation of the kernel over the sender's places, in the unit of the amount.
    pub deviation: f32,
    /// The kernel at the places, and the same without visibility.
    pub seen: f32,
    pub open: f32,
    /// Number of rays cast.
    pub rays: u32,
}

/// Light of a place in the tint of its sender, as a share of what arrives at it.
#[inline]
fn sent(place: &SenderSample, through: Vec3, dual: Vec3A) -> f32 {
    Vec3A::from(place.albedo * through).dot(dual)
}

/// Averages the kernel over the places of a sender. `dual` is the [dual](super::super::tint::duals) of its tint. `near` gives
/// the part of the link that is nearer than the root of its argument; it is asked only where the sender may be so near.
pub fn coefficient<S: Surfaces + ?Sized>(
    surfaces: &S,
    quadrature: &Quadrature,
    receiver: &Viewpoint,
    sender: usize,
    dual: Vec3A,
    near: impl FnOnce(f32) -> NearField,
) -> Coefficient {
    let area = quadrature.area(sender) / PLACES as f32;
    if area <= 0.0 {
        return Coefficient::default();
    }
    let (limit, reach) = (quadrature.near_squared(sender), quadrature.reach(sender));
    let (mut kernels, mut is_near) = ([0f32; PLACES], false);
    let mut out = Coefficient::default();
    for (kernel, place) in kernels.iter_mut().zip(quadrature.places(sender)) {
        let g = area * receiver.form_factor(place.position, place.normal, area);
        if g <= 0.0 {
            continue;
        }
        let squared = receiver.origin.distance_squared(place.position);
        is_near |= squared < reach;
        out.rays += 1;
        let through = surfaces.transmittance(receiver.origin, place.position);
        out.open += g * sent(place, Vec3::ONE, dual);
        *kernel = g * sent(place, through, dual);
        out.seen += *kernel;
        if squared >= limit {
            out.amount += *kernel;
            out.kept += if place.is_handed_on { 0.0 } else { *kernel };
        }
    }
    let mean = out.seen / PLACES as f32;
    let squares: f32 = kernels.iter().map(|kernel| (kernel - mean).powi(2)).sum();
    out.deviation = (PLACES as f32 * squares).sqrt();
    if is_near {
        let near = near(limit);
        out.amount += near.amount;
        out.kept += near.kept;
        // Where the places do not resolve the kernel it varies as much as it is.
        out.deviation = out.deviation.max(near.amount);
    }
    out
}

/// The amount of [`coefficient`] without visibility and without a near field, from places side by side.
#[inline]
pub fn unoccluded(quadrature: &Quadrature, receiver: &Viewpoint, sender: usize) -> f32 {
    let area = quadrature.area(sender) / PLACES as f32;
    let [x, y, z, nx, ny, nz, sent] = quadrature.lanes(sender);
    let (o, n, g) = (receiver.origin, receiver.normal, receiver.geometric_normal);
    let mut sum = 0.0;
    for k in 0..PLACES {
        let (dx, dy, dz) = (x[k] - o.x, y[k] - o.y, z[k] - o.z);
        let here = dx * n.x + dy * n.y + dz * n.z;
        let above = dx * g.x + dy * g.y + dz * g.z;
        let there = -(dx * nx[k] + dy * ny[k] + dz * nz[k]);
        let squared = dx * dx + dy * dy + dz * dz;
        let factor = here * there / (squared * (std::f32::consts::PI * squared + area));
        let faces = (here > 0.0) & (there > 0.0) & (above > 0.0);
        sum += if faces { factor * sent[k] } else { 0.0 };
    }
    area * sum
}
