//! Cumulative integral of a density over one parameter, as a table.

use super::legendre::{ORDER, Series, integral, inverse_integral, series};
use crate::quadrature::GAUSS_8;

/// Highest degrees of a series together are at most this part of the mean density.
const PRECISION: f64 = 1e-10;
/// Most halvings of an interval.
const DEEPEST: u32 = 18;

/// G(t) = ∫ g from the beginning of a range, for g not negative, and its inverse.
///
/// The range is halved until the Legendre series through the eight Gauss nodes of each interval has settled;
/// the series is integrated in closed form, so that value and inverse agree to rounding.
#[derive(Clone, Debug)]
pub(super) struct Cumulative {
    /// Ends of intervals, ascending.
    ends: Vec<f64>,
    /// G at them.
    sums: Vec<f64>,
    /// g between them.
    densities: Vec<Series>,
}

impl Cumulative {
    /// The integral of a density over a range, which is smooth between `breaks`: ascending, the ends of the
    /// range among them.
    pub(super) fn new(breaks: &[f64], density: impl Fn(f64) -> f64) -> Self {
        let through = |a: f64, b: f64| {
            let half = 0.5 * (b - a);
            series(&GAUSS_8.map(|(node, _)| density(a + half * (1.0 + node)).max(0.0)))
        };
        let range = breaks.last().zip(breaks.first()).map_or(1.0, |(b, a)| b - a);
        let mass: f64 = breaks.windows(2).map(|w| (w[1] - w[0]) * through(w[0], w[1])[0]).sum();
        let tolerance = PRECISION * mass / range;
        let mut table = Self { ends: breaks[..1].to_vec(), sums: vec![0.0], densities: Vec::new() };
        for pair in breaks.windows(2) {
            let mut open = vec![(pair[0], pair[1], DEEPEST)];
            while let Some((a, b, depth)) = open.pop() {
                let density = through(a, b);
                let tail = density[ORDER - 2].abs() + density[ORDER - 1].abs();
                if depth > 0 && tail > tolerance {
                    let middle = 0.5 * (a + b);
                    open.push((middle, b, depth - 1));
                    open.push((a, middle, depth - 1));
                } else {
                    let before = table.sums.last().copied().unwrap_or(0.0);
                    table.ends.push(b);
                    table.sums.push(before + ((b - a) * density[0]).max(0.0));
                    table.densities.push(density);
                }
            }
        }
        table
    }

    /// G; t is clamped to the range.
    pub(super) fn value(&self, t: f64) -> f64 {
        let i = interval(&self.ends, t);
        let [a, b] = [self.ends[i], self.ends[i + 1]];
        let x = (2.0 * (t - a) / (b - a) - 1.0).clamp(-1.0, 1.0);
        self.sums[i] + 0.5 * (b - a) * integral(&self.densities[i], x)
    }

    /// The t with this G, within the range.
    pub(super) fn inverse(&self, sum: f64) -> f64 {
        let i = interval(&self.sums, sum);
        let [a, b] = [self.ends[i], self.ends[i + 1]];
        let half = 0.5 * (b - a);
        let target = (sum - self.sums[i]).clamp(0.0, self.sums[i + 1] - self.sums[i]);
        (a + half * (1.0 + inverse_integral(&self.densities[i], target / half))).clamp(a, b)
    }
}

/// The interval between ascending ends in which a number lies; the first or last if it lies outside.
pub(super) fn interval(ends: &[f64], at: f64) -> usize {
    ends.partition_point(|&end| end <= at).clamp(1, ends.len() - 1) - 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::elementary::Elementary;

    #[test]
    fn integrals_are_those_of_closed_forms() {
        // A kink inside, and a 0.
        let table = Cumulative::new(&[-1.0, 2.0], |t| t.sine().abs());
        let exact = |t: f64| {
            if t < 0.0 { t.cosine() - 1_f64.cosine() } else { 2.0 - 1_f64.cosine() - t.cosine() }
        };
        for i in 0..=300 {
            let t = -1.0 + f64::from(i) / 100.0;
            assert!((table.value(t) - exact(t)).abs() < 1e-9, "{t}");
            let back = table.inverse(table.value(t));
            assert!((table.value(back) - table.value(t)).abs() < 1e-12);
            assert!(t.abs() < 0.01 || (back - t).abs() < 1e-9, "{t} {back}");
        }
        assert!(table.inverse(-1.0) == -1.0 && table.inverse(10.0) == 2.0);
    }
}
