//! Coarse transport matrix C = F P: the irradiance of coarse points from other coarse points. Light
//! leaves coarse points interpolated (P) to the finest senders and arrives over the links T (F is
//! the part of T that ends at coarse points).

use super::accumulator::SparseAccumulator;
use super::{OperatorSettings, tint};
use crate::transport::operator::IrradianceRow;
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use rebounce_shared::interpolation::Rows;
use rebounce_shared::link::{Link, Sent};

/// The coarse transport matrix, computed row by row.
pub struct CoarseMatrix<'a> {
    /// Irradiance of each coarse point from all senders (F).
    values: &'a [Vec<Link>],
    /// Shares of the coarse points in the light of each sender (P).
    from: Vec<IrradianceRow>,
    /// Colours of the senders, and their [duals](tint::duals).
    tints: Vec<Vec3>,
    duals: Vec<Vec3A>,
    least: f32,
}

impl<'a> CoarseMatrix<'a> {
    /// Prepares the rows. `values` are the coarse points' irradiance from all senders (F). Bounced light of a finer
    /// sender is interpolated from its parents by `push`, recursively up to the coarse points (P). `tints` are the
    /// senders'.
    pub fn new(values: &'a [Vec<Link>], push: Rows, tints: &[u32], settings: &OperatorSettings) -> Self {
        let count = values.len();
        let mut from: Vec<IrradianceRow> =
            (0..count.min(tints.len())).map(|i| vec![(i as u32, 1.0)]).collect();
        let mut tally = SparseAccumulator::<1>::new(count);
        for i in from.len()..tints.len() {
            let parents = push.row(i);
            let total: f32 = parents.iter().map(|parent| parent.weight()).sum();
            for parent in parents {
                let share = parent.weight() / total;
                from[parent.point()].iter().for_each(|(j, weight)| tally.add(0, *j as usize, share * weight));
            }
            from.push(tally.row(0.0, 0));
            tally.clear();
        }
        Self {
            values,
            from,
            tints: tint::unpack(tints),
            duals: tint::duals(tints),
            least: settings.least_irradiance(),
        }
    }

    /// Number of rows.
    pub fn count(&self) -> usize {
        self.values.len()
    }

    /// Computes all rows.
    pub fn rows(&self) -> Vec<IrradianceRow> {
        let rows = (0..self.count()).into_par_iter();
        rows.map_init(|| self.scratch(), |scratch, i| self.row(i, scratch)).collect()
    }

    /// Returns empty working memory for [`Self::row`].
    pub fn scratch(&self) -> SparseAccumulator<1> {
        SparseAccumulator::new(self.count())
    }

    /// Computes the irradiance of coarse point `i` from every other, in the tint of the sending coarse point.
    pub fn row(&self, i: usize, scratch: &mut SparseAccumulator<1>) -> IrradianceRow {
        for link in &self.values[i] {
            let sent = link.amount() * self.tints[link.sender()];
            for (j, weight) in &self.from[link.sender()] {
                let dual = self.duals[*j as usize];
                scratch.add(0, *j as usize, weight * sent.dot(dual.into()));
            }
        }
        let row = scratch.row(self.least, i as u64);
        scratch.clear();
        row
    }
}
