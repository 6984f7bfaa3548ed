//! Means of light over near patches and points.

use glam::Vec3;
use rayon::prelude::*;
use rebounce::transport::antiradiance::near::{AreaPoint, Near};
use rebounce_shared::antiradiance::Patch;
use rebounce_shared::baked::BakedScene;

/// How far a patch or a point has a weight, in sides of a square of its mean area.
const REACH: f32 = 2.0;

/// Means of the values of near patches, at the patches themselves.
pub fn smooth(patches: &[Patch], values: &[Vec3]) -> Vec<Vec3> {
    means(patches, values, patches.iter().map(|patch| [patch.position(), patch.normal]).collect())
}

/// Means of the values of near patches, at places with normals.
pub fn means(patches: &[Patch], values: &[Vec3], at: Vec<[Vec3; 2]>) -> Vec<Vec3> {
    let places: Vec<AreaPoint> = patches.iter().map(AreaPoint::from).collect();
    let area: f32 = places.iter().map(|place| place.area).sum();
    let near = Near::new(&places, REACH * (area / places.len() as f32).sqrt());
    let mean = |[place, normal]: &[Vec3; 2]| near.mean(*place, *normal, values).unwrap_or(Vec3::ZERO);
    at.par_iter().map(mean).collect()
}

/// A point of a file; all count alike.
pub fn area_point(baked: &BakedScene, point: usize) -> AreaPoint {
    let point = &baked.points[point];
    AreaPoint { position: point.position(), normal: point.normal(), area: 1.0 }
}

/// Values of points at patches of the room.
pub fn at(patches: &[Patch], points: &[AreaPoint], values: &[Vec3]) -> Vec<Vec3> {
    let area: f32 = patches.iter().map(Patch::area).sum();
    let near = Near::new(points, REACH * (area / points.len() as f32).sqrt());
    let at = |patch: &Patch| near.mean(patch.position(), patch.normal, values).unwrap_or(Vec3::ZERO);
    patches.par_iter().map(at).collect()
}
