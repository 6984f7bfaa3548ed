//! Points of glossy surfaces, and the points that those interpolate.

use super::GlossSettings;
use crate::geometry::{Gloss, Ray, Surfaces};
use crate::sampling::{Points, SurfacePoint};
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;

/// Points with glossy transfer.
pub(super) struct GlossyPoints {
    /// Indices, ascending: coarsest level first.
    pub points: Vec<u32>,
    /// First of these on each level, and one past the end.
    pub levels: Vec<usize>,
}

/// Whether pictures show reflections of a surface.
pub(super) fn is_glossy(gloss: Gloss, settings: &GlossSettings) -> bool {
    let limit = if gloss.is_metal() { settings.metals } else { settings.dielectrics };
    gloss.roughness < limit && (gloss.is_metal() || gloss.specular > 0.0)
}

/// How the surface under a point shines.
fn gloss_at<S: Surfaces + ?Sized>(surfaces: &S, point: &SurfacePoint) -> Option<Gloss> {
    let height = 4.0 * surfaces.epsilon_at(point.position);
    let ray = Ray {
        origin: point.position + height * point.geometric_normal,
        direction: -point.geometric_normal,
        max_distance: 3.0 * height,
        spread: 0.0,
    };
    surfaces.cast(&ray, 0).map(|hit| hit.gloss)
}

impl GlossyPoints {
    /// Finds the points of the finest level on glossy surfaces, their parents, and so on.
    pub fn find<S: Surfaces + ?Sized>(
        surfaces: &S,
        points: &Points,
        file: &BakedScene,
        settings: &GlossSettings,
    ) -> Self {
        let shines = |point| gloss_at(surfaces, point).is_some_and(|gloss| is_glossy(gloss, settings));
        let finest = file.display();
        let mut is_used = vec![false; points.points.len()];
        let found: Vec<bool> = points.points[finest.clone()].par_iter().map(shines).collect();
        is_used[finest].copy_from_slice(&found);
        for i in (0..is_used.len()).rev() {
            if is_used[i] {
                file.push().row(i).iter().for_each(|entry| is_used[entry.point()] = true);
            }
        }
        let all = (0u32..).zip(&is_used).filter(|(_, used)| **used).map(|(i, _)| i);
        let points: Vec<u32> = all.collect();
        let before = |end: u32| points.partition_point(|point| *point < end);
        let mut levels: Vec<usize> = file.meta.levels.iter().map(|level| before(level.first)).collect();
        levels.push(points.len());
        Self { points, levels }
    }
}
