//! Level of the senders at a hit: the coarsest whose functions look small from the receiver (the report, section 6.3, after
//! Bekaert et al. 1998).

use crate::basis::{Evaluator, FetchStep, sender_evaluator};
use crate::sampling::Points;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::kernel::LEAST_WEIGHT;
use std::f32::consts::TAU;

/// A place of a surface that light may leave from.
#[derive(Clone, Copy, Debug)]
pub struct SurfacePlace {
    /// Local space.
    pub position: Vec3,
    /// Unit shading normal.
    pub normal: Vec3,
    /// Reconstruction group.
    pub group: u32,
}

/// Functions of all levels as senders.
pub struct SenderLevels {
    levels: Vec<Evaluator>,
    /// Distance from which the functions of each level are small enough, scene units.
    distances: Vec<f32>,
}

/// Returns the distance from which a sphere of this radius has a solid angle of at most ε_Ω: that of a cone of half angle θ is
/// 2π (1 − cos θ), and sin θ = radius / distance.
fn far_enough(radius: f32, epsilon_omega: f32) -> f32 {
    let cosine = 1.0 - epsilon_omega / TAU;
    if cosine <= 0.0 { radius } else { radius / (1.0 - cosine * cosine).max(f32::MIN_POSITIVE).sqrt() }
}

impl SenderLevels {
    /// Prepares the functions of all levels.
    pub fn new(points: &Points, epsilon_omega: f32) -> Self {
        let levels = (0..points.levels.len()).into_par_iter().map(|level| sender_evaluator(points, level));
        // The functions of a level have one radius: their average solid angle is that of each.
        let distances = points.levels.iter().map(|level| far_enough(level.support_radius, epsilon_omega));
        Self { distances: distances.collect(), levels: levels.collect() }
    }

    /// Returns the coarsest level whose functions are small enough at a distance; the finest where none is.
    fn at(&self, distance: f32) -> usize {
        let last = self.levels.len().saturating_sub(1);
        self.distances[..last].iter().position(|least| distance >= *least).unwrap_or(last)
    }

    /// Prefetches what [`Self::interpolate`] reads.
    #[inline]
    pub fn fetch(&self, distance: f32, position: Vec3, step: FetchStep) {
        if let Some(level) = self.levels.get(self.at(distance)) {
            level.fetch(position, step);
        }
    }

    /// Fills `out` with (index, normalised weight) of the functions that cover a place, on the level for a distance. Where no
    /// function of that level does, a small thing lies between them: finer levels follow, then coarser ones. Empty where none
    /// does.
    pub fn interpolate(&self, distance: f32, place: &SurfacePlace, out: &mut Vec<(u32, f32)>) {
        let (level, &SurfacePlace { position, normal, group }) = (self.at(distance), place);
        for level in (level..self.levels.len()).chain((0..level).rev()) {
            out.clear();
            let total = self.levels[level].gather(position, normal, group, |i, weight| out.push((i, weight)));
            if total > LEAST_WEIGHT {
                let scale = 1.0 / total;
                out.iter_mut().for_each(|entry| entry.1 *= scale);
                return;
            }
        }
        out.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sphere_at_the_distance_has_the_solid_angle() {
        for epsilon in [0.01, 0.1, 0.314, 3.0] {
            let distance = far_enough(0.3, epsilon);
            let sine = 0.3 / distance;
            let angle = TAU * (1.0 - (1.0 - sine * sine).sqrt());
            assert!((angle - epsilon).abs() < 1e-3 * epsilon, "{angle}, not {epsilon}");
        }
        assert_eq!(far_enough(0.3, 7.0), 0.3);
    }
}
