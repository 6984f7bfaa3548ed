//! What the scene's surfaces get from each function of the environment: the operator applied to 25 skies.

use crate::basis::Leveled;
use crate::geometry::Hit;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::environment::bins::{BINS, direction};
use rebounce_shared::harmonics::{COUNT, evaluate};
use rebounce_shared::relight;

/// Rows and columns of the directions in a bin over which a function is averaged.
const WITHIN: usize = 4;

/// Irradiance of surfaces by function of the environment, RGB: direct and bounced.
pub(super) struct SkyIrradiance {
    basis: Leveled,
    /// By point.
    irradiance: Vec<[Vec3; COUNT]>,
}

impl SkyIrradiance {
    /// Relights a file by each function.
    pub fn new(file: &BakedScene) -> Self {
        let functions: Vec<Vec<Vec3>> = (0..COUNT).into_par_iter().map(|k| relit_by(file, k)).collect();
        let of_point = |i: usize| std::array::from_fn(|k| functions[k][i]);
        Self {
            basis: Leveled::of_baked(file),
            irradiance: (0..file.points.len()).into_par_iter().map(of_point).collect(),
        }
    }

    /// Radiance that a hit sends back, by function. `weights` is room to work in.
    pub fn radiance(&self, hit: &Hit, weights: &mut Vec<(u32, f32)>) -> [Vec3; COUNT] {
        let mut sums = [Vec3::ZERO; COUNT];
        if hit.albedo == Vec3::ZERO {
            return sums;
        }
        self.basis.interpolate(hit.position, hit.normal, hit.group, weights);
        for (point, weight) in &*weights {
            let values = &self.irradiance[*point as usize];
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += *value * *weight);
        }
        let reflected = hit.albedo * std::f32::consts::FRAC_1_PI;
        sums.map(|sum| sum * reflected)
    }
}

/// Irradiance of all points under a sky with the radiance of a function.
fn relit_by(file: &BakedScene, k: usize) -> Vec<Vec3> {
    let mean = |bin: usize| {
        let places = (0..WITHIN * WITHIN)
            .map(|i| (Vec2::new((i % WITHIN) as f32, (i / WITHIN) as f32) + 0.5) / WITHIN as f32);
        let sum: f32 = places.map(|at| evaluate(direction(bin, at))[k]).sum();
        Vec3::splat(sum / (WITHIN * WITHIN) as f32)
    };
    let sky: [Vec3; BINS] = std::array::from_fn(mean);
    let dark = vec![Vec3::ZERO; file.sources.groups.len()];
    let direct = relight::from_sources(file, &file.sources.strengths(Some(&sky), &dark));
    let bounced = relight::relight(file, direct[..file.direct_count()].to_vec());
    direct.into_iter().zip(bounced).map(|(direct, bounced)| direct + bounced).collect()
}
