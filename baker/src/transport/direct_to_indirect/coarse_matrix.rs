//! Coarse transport matrix C = F P: the irradiance of coarse points from other coarse points. Light
//! leaves coarse points interpolated (P) to the finest senders and arrives over the links T (F is
//! the part of T that ends at coarse points).

use super::accumulator::{IrradianceRow, SparseAccumulator};
use super::{OperatorSettings, tint};
use crate::job::watch::{Stopped, Watch};
use rayon::prelude::*;
use rebounce_shared::interpolation::Rows;
use rebounce_shared::link::{Link, Sent};

/// Computes the irradiance of each coarse point from every other. `values` are the coarse points'
/// irradiance from all senders (F). Bounced light of a finer sender is interpolated from its
/// parents by `push`, recursively up to the coarse points (P). A row's amounts are in the tint of
/// the sending coarse point; `tints` are the senders'. A unit of `watch` is a row.
///
/// # Errors
/// [`Stopped`].
pub fn coarse_rows(
    values: &[Vec<Link>],
    push: Rows,
    tints: &[u32],
    settings: &OperatorSettings,
    watch: &dyn Watch,
) -> Result<Vec<IrradianceRow>, Stopped> {
    let count = values.len();
    let mut from: Vec<IrradianceRow> = (0..count.min(tints.len())).map(|i| vec![(i as u32, 1.0)]).collect();
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
    let (duals, tints) = (tint::duals(tints), tint::unpack(tints));
    let row = |tally: &mut SparseAccumulator<1>, (i, value): (usize, &Vec<Link>)| {
        for link in value {
            let sent = link.amount() * tints[link.sender()];
            for (j, weight) in &from[link.sender()] {
                let dual = duals[*j as usize];
                tally.add(0, *j as usize, weight * sent.dot(dual.into()));
            }
        }
        let row = tally.row(settings.least_irradiance(), i as u64);
        tally.clear();
        watch.step(1)?;
        Ok(row)
    };
    values.par_iter().enumerate().map_init(|| SparseAccumulator::<1>::new(count), row).collect()
}
