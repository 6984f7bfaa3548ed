//! The threads of this process, for the passes of [`rebounce_shared::antiradiance`].

use glam::Vec3;
use rayon::prelude::*;
use rebounce_shared::antiradiance::{Transfer, Workers};

/// Rayon's threads.
#[derive(Clone, Copy, Debug, Default)]
pub struct Pool;

impl Workers for Pool {
    fn rows(&self, table: &mut [Vec3], width: usize, each: &(dyn Fn(usize, &mut [Vec3]) + Sync)) {
        table.par_chunks_exact_mut(width.max(1)).enumerate().for_each(|(i, row)| each(i, row));
    }

    fn lists(&self, count: usize, each: &(dyn Fn(usize) -> Vec<Transfer> + Sync)) -> Vec<Vec<Transfer>> {
        (0..count).into_par_iter().map(each).collect()
    }
}
