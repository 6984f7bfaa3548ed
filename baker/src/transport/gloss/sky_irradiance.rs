//! What the scene's surfaces get from each function of the environment.

use crate::basis::Leveled;
use crate::geometry::Hit;
use crate::transport::environment::sky_functions::by_sky_functions;
use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::harmonics::COUNT;

/// Irradiance of surfaces by function of the environment, RGB: direct and bounced.
pub(super) struct SkyIrradiance {
    basis: Leveled,
    /// By point.
    irradiance: Vec<[Vec3; COUNT]>,
}

impl SkyIrradiance {
    /// Relights a file by each function.
    pub fn new(file: &BakedScene) -> Self {
        let functions = by_sky_functions(file);
        let of_point = |i: usize| std::array::from_fn(|k| functions[k].direct[i] + functions[k].bounced[i]);
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
