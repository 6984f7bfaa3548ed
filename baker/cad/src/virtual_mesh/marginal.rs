//! Equal-area map of a surface whose area element depends on both parameters.

use super::cumulative::interval;
use super::legendre::{ORDER, Series, integral, inverse_integral, polynomials, series};
use crate::quadrature::GAUSS_8;
use glam::DVec2;

/// Highest degrees of a series together are at most this part of the mean density.
const PRECISION: f64 = 1e-6;
/// Intervals in one direction are halved while there are no more than this, besides those between breaks.
const MOST_INTERVALS: usize = 48;

/// x = ∫ M du with the marginal M(u) = ∫ g dv, and y = ∫ g dv / M from the beginning of v: Equation 2 of
/// Alonso et al. 2001 with f′ = 1 / M. The Jacobian is 1: x goes from 0 to the area, y from 0 to 1.
///
/// g is interpolated by tensor products of Legendre polynomials through 8 × 8 Gauss nodes in the cells of a
/// grid, which is refined until they settle; all integrals of the interpolant are closed forms. Beyond the
/// rectangle parameters are clamped.
#[derive(Clone, Debug)]
pub(super) struct Marginal {
    /// Ends of intervals in u and in v, ascending.
    ends: [Vec<f64>; 2],
    /// g in the cells, v fastest: a series in v for each degree in u.
    cells: Vec<[Series; ORDER]>,
    /// M in the intervals of u.
    marginals: Vec<Series>,
    /// ∫ M at the ends in u.
    sums: Vec<f64>,
}

impl Marginal {
    /// The map of a density that is smooth between `breaks` in u and in v: ascending, the ends of the
    /// rectangle among them.
    pub(super) fn new(breaks: [Vec<f64>; 2], density: impl Fn(DVec2) -> f64) -> Self {
        let most = [0, 1].map(|direction| MOST_INTERVALS + breaks[direction].len());
        let mut ends = breaks;
        loop {
            let cells = interpolated(&ends, &density);
            let rough = unsettled(&ends, &cells);
            let mut refined = false;
            let finer = [0, 1].map(|direction| {
                let ends = &ends[direction];
                let mut finer = vec![ends[0]];
                for (pair, &is_rough) in ends.windows(2).zip(&rough[direction]) {
                    if is_rough && finer.len() < most[direction] && ends.len() < most[direction] {
                        finer.push(0.5 * (pair[0] + pair[1]));
                        refined = true;
                    }
                    finer.push(pair[1]);
                }
                finer
            });
            if !refined {
                return Self::integrated(ends, cells);
            }
            ends = finer;
        }
    }

    fn integrated(ends: [Vec<f64>; 2], cells: Vec<[Series; ORDER]>) -> Self {
        let rows = ends[1].len() - 1;
        let mut sums = vec![0.0];
        let mut marginals = Vec::new();
        for (column, side) in cells.chunks(rows).zip(ends[0].windows(2)) {
            let mut marginal = [0.0; ORDER];
            for (cell, row) in column.iter().zip(ends[1].windows(2)) {
                for (sum, series) in marginal.iter_mut().zip(cell) {
                    *sum += (row[1] - row[0]) * series[0];
                }
            }
            let before = sums.last().copied().unwrap_or(0.0);
            sums.push(before + ((side[1] - side[0]) * marginal[0]).max(0.0));
            marginals.push(marginal);
        }
        Self { ends, cells, marginals, sums }
    }

    /// The interval of a u, and where u is in it, −1 to 1.
    fn column(&self, u: f64) -> (usize, f64) {
        let i = interval(&self.ends[0], u);
        (i, local(&self.ends[0], i, u))
    }

    /// g along v at a u: its series in each interval of v, and ∫ g dv at their ends.
    fn conditional(&self, i: usize, x: f64) -> (Vec<Series>, Vec<f64>) {
        let rows = self.ends[1].len() - 1;
        let p = polynomials(x);
        let mut sums = vec![0.0];
        let mut along = Vec::with_capacity(rows);
        for (cell, row) in self.cells[i * rows..][..rows].iter().zip(self.ends[1].windows(2)) {
            let mut sum = [0.0; ORDER];
            for (series, p) in cell.iter().zip(p) {
                for (sum, coefficient) in sum.iter_mut().zip(series) {
                    *sum += p * coefficient;
                }
            }
            let before = sums.last().copied().unwrap_or(0.0);
            sums.push(before + ((row[1] - row[0]) * sum[0]).max(0.0));
            along.push(sum);
        }
        (along, sums)
    }

    /// From (u, v) to (x, y).
    pub(super) fn flat(&self, at: DVec2) -> DVec2 {
        let (i, x) = self.column(at.x);
        let half = 0.5 * (self.ends[0][i + 1] - self.ends[0][i]);
        let across = self.sums[i] + half * integral(&self.marginals[i], x);
        let (along, sums) = self.conditional(i, x);
        let whole = sums.last().copied().unwrap_or(0.0);
        let ends = &self.ends[1];
        let j = interval(ends, at.y);
        let y = local(ends, j, at.y);
        let part = sums[j] + 0.5 * (ends[j + 1] - ends[j]) * integral(&along[j], y);
        // Where a border of the surface is a point.
        let is_point = whole <= f64::EPSILON * self.marginals[i][0].abs();
        let uniform = (at.y - ends[0]) / (ends[ends.len() - 1] - ends[0]);
        DVec2::new(across, if is_point { uniform.clamp(0.0, 1.0) } else { part / whole })
    }

    /// From (x, y) to (u, v).
    pub(super) fn parameters(&self, flat: DVec2) -> DVec2 {
        let [us, vs] = &self.ends;
        let i = interval(&self.sums, flat.x);
        let half = 0.5 * (us[i + 1] - us[i]);
        let target = (flat.x - self.sums[i]).clamp(0.0, self.sums[i + 1] - self.sums[i]);
        let x = inverse_integral(&self.marginals[i], target / half);
        let (along, sums) = self.conditional(i, x);
        let whole = sums.last().copied().unwrap_or(0.0);
        let y = flat.y.clamp(0.0, 1.0);
        let v = if whole <= f64::EPSILON * self.marginals[i][0].abs() {
            vs[0] + y * (vs[vs.len() - 1] - vs[0])
        } else {
            let j = interval(&sums, y * whole);
            let half = 0.5 * (vs[j + 1] - vs[j]);
            let target = (y * whole - sums[j]).clamp(0.0, sums[j + 1] - sums[j]);
            vs[j] + half * (1.0 + inverse_integral(&along[j], target / half))
        };
        DVec2::new(us[i] + half * (1.0 + x), v)
    }
}

/// Where a parameter is in an interval, −1 to 1.
fn local(ends: &[f64], i: usize, at: f64) -> f64 {
    (2.0 * (at - ends[i]) / (ends[i + 1] - ends[i]) - 1.0).clamp(-1.0, 1.0)
}

/// g in all cells of a grid.
fn interpolated(ends: &[Vec<f64>; 2], density: impl Fn(DVec2) -> f64) -> Vec<[Series; ORDER]> {
    let mut cells = Vec::with_capacity((ends[0].len() - 1) * (ends[1].len() - 1));
    let place = |pair: &[f64], node: f64| pair[0] + 0.5 * (pair[1] - pair[0]) * (1.0 + node);
    for column in ends[0].windows(2) {
        for row in ends[1].windows(2) {
            let along = GAUSS_8.map(|(u, _)| {
                series(&GAUSS_8.map(|(v, _)| density(DVec2::new(place(column, u), place(row, v)))))
            });
            let mut cell = [[0.0; ORDER]; ORDER];
            for degree in 0..ORDER {
                let across = series(&along.map(|series| series[degree]));
                for (k, coefficient) in across.into_iter().enumerate() {
                    cell[k][degree] = coefficient;
                }
            }
            cells.push(cell);
        }
    }
    cells
}

/// In which intervals of u and of v a series has not settled.
fn unsettled(ends: &[Vec<f64>; 2], cells: &[[Series; ORDER]]) -> [Vec<bool>; 2] {
    let rows = ends[1].len() - 1;
    let mean = cells.iter().map(|cell| cell[0][0]).sum::<f64>() / cells.len() as f64;
    let mut rough = [vec![false; ends[0].len() - 1], vec![false; rows]];
    for (index, cell) in cells.iter().enumerate() {
        let high = ORDER - 2..ORDER;
        let in_u: f64 = cell[high.clone()].iter().flatten().map(|c| c.abs()).sum();
        let in_v: f64 = cell.iter().flat_map(|series| &series[high.clone()]).map(|c| c.abs()).sum();
        rough[0][index / rows] |= in_u > PRECISION * mean;
        rough[1][index % rows] |= in_v > PRECISION * mean;
    }
    rough
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::elementary::Elementary;

    #[test]
    fn jacobian_is_one_and_points_come_back() {
        let density = |at: DVec2| 1.0 + (3.0 * at.x).sine() * at.y + at.x * at.x * (2.0 * at.y).exponential();
        let map = Marginal::new([vec![0.0, 0.4, 1.0], vec![-1.0, 1.0]], density);
        for i in 1..30 {
            for j in 1..30 {
                let at = DVec2::new(f64::from(i) / 30.0, f64::from(j) / 15.0 - 1.0);
                let flat = map.flat(at);
                assert!(map.parameters(flat).distance(at) < 1e-12);
                let h = 1e-5;
                let along_u = (map.flat(at + h * DVec2::X) - map.flat(at - h * DVec2::X)) / (2.0 * h);
                let along_v = (map.flat(at + h * DVec2::Y) - map.flat(at - h * DVec2::Y)) / (2.0 * h);
                let jacobian = along_u.perp_dot(along_v) / density(at);
                assert!((jacobian - 1.0).abs() < 1e-5, "{at}: {jacobian}");
            }
        }
    }
}
