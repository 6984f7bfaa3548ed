//! The surfaces of models at their places, for what looks around a point: clip planes and direct-light samples.

use super::accelerator::{Accelerator, PlacedModels};
use super::traversal::{Ray, nearest_within, transmittance};
use crate::baked::BakedScene;
use crate::rbn::bulk::Point;
use crate::surroundings::{SupportedPoint, SurroundingHit, Surroundings};
use glam::Vec3;

/// Offset of ray origins from surfaces, over the diagonal of the scene, and over the greatest coordinate: the baker's.
const EPSILON: f32 = 3e-6;
const EPSILON_AWAY: f32 = 6e-6;
/// The offset's greatest part of the finest support: a wide landscape around a house does not lift rays off its floors.
const FINEST: f32 = 1e-3;

/// Surfaces of models at their places.
#[derive(Clone, Copy, Debug)]
pub struct PlacedSurfaces<'a> {
    /// BVHs of the models.
    pub accelerator: &'a Accelerator,
    /// Models at their places.
    pub placed: &'a PlacedModels,
    /// Least offset of ray origins from surfaces, scene units.
    pub epsilon: f32,
}

impl<'a> PlacedSurfaces<'a> {
    /// The surfaces of a scene's models at these places.
    pub fn new(scene: &BakedScene, accelerator: &'a Accelerator, placed: &'a PlacedModels) -> Self {
        let diagonal = (Vec3::from(scene.meta.bounds_max) - Vec3::from(scene.meta.bounds_min)).length();
        let finest = scene.meta.levels.last().map_or(0.0, |level| level.support_radius);
        Self { accelerator, placed, epsilon: (EPSILON * diagonal).min(FINEST * finest) }
    }

    /// A point of the file where its group is. A file has shading normals alone.
    pub fn supported(&self, point: &Point) -> SupportedPoint {
        let (position, normal) = (point.position(), point.normal());
        let epsilon = self.epsilon.max(EPSILON_AWAY * position.abs().max_element());
        SupportedPoint { position, normal, geometric_normal: normal, radius: point.radius, epsilon }
    }
}

impl Surroundings for PlacedSurfaces<'_> {
    fn cast(&self, origin: Vec3, direction: Vec3, max_distance: f32, seed: u32) -> Option<SurroundingHit> {
        let ray = Ray { origin, direction, seed };
        let hit = nearest_within(self.accelerator, self.placed, &ray, max_distance)?;
        Some(SurroundingHit {
            distance: hit.distance,
            position: origin + direction * hit.distance,
            geometric_normal: hit.normal,
            normal: hit.normal,
            faces: !hit.is_dark,
        })
    }

    fn is_open(&self, from: Vec3, to: Vec3) -> bool {
        transmittance(self.accelerator, self.placed, from, to) >= 0.5
    }
}
