//! Surfaces of a bake around a point.

use super::SurfacePoint;
use crate::geometry::{Ray, Surfaces};
use glam::Vec3;
use rebounce_shared::surroundings::{SupportedPoint, SurroundingHit, Surroundings};

/// Surfaces of a bake, for the laws of clip planes and of direct-light samples.
pub(super) struct Around<'a, S: ?Sized>(pub &'a S);

impl<S: Surfaces + ?Sized> Surroundings for Around<'_, S> {
    fn cast(&self, origin: Vec3, direction: Vec3, max_distance: f32, seed: u32) -> Option<SurroundingHit> {
        let hit = self.0.cast(&Ray { origin, direction, max_distance, spread: Ray::VISIBILITY }, seed)?;
        Some(SurroundingHit {
            distance: hit.distance,
            position: hit.position,
            geometric_normal: hit.geometric_normal,
            normal: hit.normal,
            faces: hit.faces(direction),
        })
    }

    fn is_open(&self, from: Vec3, to: Vec3) -> bool {
        self.0.transmittance(from, to).element_sum() >= 1.5
    }
}

/// A point with a support of this radius.
pub(super) fn supported<S: Surfaces + ?Sized>(
    surfaces: &S,
    point: &SurfacePoint,
    radius: f32,
) -> SupportedPoint {
    let SurfacePoint { position, normal, geometric_normal, .. } = *point;
    SupportedPoint { position, normal, geometric_normal, radius, epsilon: surfaces.epsilon_at(position) }
}
