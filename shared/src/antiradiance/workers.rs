//! Who does the work: one thread, or those that a caller brings.

use super::transfer::Transfer;
use glam::Vec3;

/// Runs independent pieces of work. The result does not depend on their order.
pub trait Workers: Sync {
    /// Calls `each` for every row of a table of `width` columns, with its index.
    fn rows(&self, table: &mut [Vec3], width: usize, each: &(dyn Fn(usize, &mut [Vec3]) + Sync));

    /// Returns what `each` returns for every index below `count`, in order.
    fn lists(&self, count: usize, each: &(dyn Fn(usize) -> Vec<Transfer> + Sync)) -> Vec<Vec<Transfer>>;
}

/// One after the other.
#[derive(Clone, Copy, Debug, Default)]
pub struct Serial;

impl Workers for Serial {
    fn rows(&self, table: &mut [Vec3], width: usize, each: &(dyn Fn(usize, &mut [Vec3]) + Sync)) {
        table.chunks_exact_mut(width.max(1)).enumerate().for_each(|(i, row)| each(i, row));
    }

    fn lists(&self, count: usize, each: &(dyn Fn(usize) -> Vec<Transfer> + Sync)) -> Vec<Vec<Transfer>> {
        (0..count).map(each).collect()
    }
}
