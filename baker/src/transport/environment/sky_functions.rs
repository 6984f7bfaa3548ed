//! What the points of a file get from each function of the environment: the operator applied to 25 skies.

use glam::{Vec2, Vec3};
use rayon::prelude::*;
use rebounce_shared::baked::BakedScene;
use rebounce_shared::environment::bins::{BINS, direction};
use rebounce_shared::harmonics::{COUNT, evaluate};
use rebounce_shared::relight;

/// Rows and columns of the directions in a bin over which a function is averaged.
const WITHIN: usize = 4;

/// Irradiance of all points along their normals.
pub struct PointIrradiance {
    /// Straight from the sky or from emissive surfaces.
    pub direct: Vec<Vec3>,
    /// Of light that bounced.
    pub bounced: Vec<Vec3>,
}

impl PointIrradiance {
    /// Relights a file by these strengths of its sources.
    pub fn relit(file: &BakedScene, strengths: &[Vec3]) -> Self {
        let direct = relight::from_sources(file, strengths);
        let bounced = relight::relight(file, direct[..file.direct_count()].to_vec());
        Self { direct, bounced }
    }
}

/// Relights a file by the sky of each function, in order. The file has links from the sky.
pub fn by_sky_functions(file: &BakedScene) -> Vec<PointIrradiance> {
    let dark = vec![Vec3::ZERO; file.sources.groups.len()];
    let of = |k: usize| PointIrradiance::relit(file, &file.sources.strengths(Some(&sky(k)), &dark));
    (0..COUNT).into_par_iter().map(of).collect()
}

/// Mean of a function in each bin.
fn sky(k: usize) -> [Vec3; BINS] {
    std::array::from_fn(|bin| {
        let places = (0..WITHIN * WITHIN)
            .map(|i| (Vec2::new((i % WITHIN) as f32, (i / WITHIN) as f32) + 0.5) / WITHIN as f32);
        let sum: f32 = places.map(|at| evaluate(direction(bin, at))[k]).sum();
        Vec3::splat(sum / (WITHIN * WITHIN) as f32)
    })
}
