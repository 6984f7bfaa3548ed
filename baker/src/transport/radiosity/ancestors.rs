//! Coarse ancestors: the coarse points from which the value of a finer point is interpolated, level by level (P).

use crate::basis::Relations;
use crate::transport::direct_to_indirect::accumulator::SparseAccumulator;

/// Least share of an ancestor that counts; the shares of the others make up for it.
const LEAST: f32 = 0.02;

/// Coarse ancestors of every point, with their shares.
pub struct Ancestors {
    /// Offset of each point's first ancestor, and of the end of the last one's.
    offsets: Vec<u32>,
    /// Ancestors (coarse point, share); the shares of a point sum to 1.
    entries: Vec<(u32, f32)>,
    coarse: usize,
}

impl Ancestors {
    /// Finds the ancestors of `points` points among the first `coarse`.
    pub fn new(relations: &Relations, points: usize, coarse: usize) -> Self {
        let mut out = Self { offsets: vec![0], entries: Vec::new(), coarse };
        let mut shares = SparseAccumulator::<1>::new(coarse);
        for i in 0..points {
            if i < coarse {
                out.entries.push((i as u32, 1.0));
            } else {
                let row = relations.push().row(i);
                let total: f32 = row.iter().map(|parent| parent.weight()).sum();
                for parent in row {
                    let share = parent.weight() / total;
                    out.each(parent.point() as u32, |j, of| shares.add(0, j as usize, share * of));
                }
                let mut kept = 0.0;
                shares.each(|_, [share]| kept += if share >= LEAST { share } else { 0.0 });
                shares.each(|j, [share]| {
                    if share >= LEAST {
                        out.entries.push((j, share / kept));
                    }
                });
                shares.clear();
            }
            out.offsets.push(out.entries.len() as u32);
        }
        out
    }

    /// Number of coarse points.
    pub fn coarse(&self) -> usize {
        self.coarse
    }

    /// Calls `visit` with each ancestor of a point and its share.
    #[inline]
    pub fn each(&self, point: u32, mut visit: impl FnMut(u32, f32)) {
        let point = point as usize;
        let range = self.offsets[point] as usize..self.offsets[point + 1] as usize;
        self.entries[range].iter().for_each(|(ancestor, share)| visit(*ancestor, *share));
    }
}
