//! Gaussian spreading of senders wider than a bin (antiradiance paper, section 3.1): the energy of one bin goes to its
//! neighbours too.
//!
//! The variance is that of the sender's disc, so that a sender as wide as several bins is that wide; the paper's is the
//! distance of neighbouring bins.

use super::bins::Bins;
use crate::elementary::Elementary;
use glam::Vec3;

/// Number of widths; 0 is the bin alone.
pub const WIDTHS: usize = 8;
/// Weights below this are left out.
const LEAST: f32 = 0.01;

/// Bins that receive the light of a bin, by width and bin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spread {
    /// First cell of each width and bin, width after width, and the number of cells at the end.
    pub offsets: Vec<u32>,
    /// Receiving bins.
    pub bins: Vec<u32>,
    /// Their shares; those of a row add up to 1.
    pub shares: Vec<f32>,
}

impl Spread {
    /// Shares for all widths.
    pub fn new(bins: &Bins) -> Self {
        let mut out = Self { offsets: vec![0], ..Self::default() };
        for width in 0..WIDTHS {
            let radius = radius(bins, width);
            for (own, middle) in bins.directions.iter().enumerate() {
                let begin = out.bins.len();
                if width == 0 {
                    out.bins.push(own as u32);
                    out.shares.push(1.0);
                } else {
                    out.row(bins, *middle, radius);
                }
                let sum: f32 = out.shares[begin..].iter().sum();
                out.shares[begin..].iter_mut().for_each(|share| *share /= sum);
                out.offsets.push(out.bins.len() as u32);
            }
        }
        out
    }

    /// Adds the weights around a direction: a Gaussian of the variance of a disc of this angular radius, along each axis
    /// a quarter of its square.
    fn row(&mut self, bins: &Bins, middle: Vec3, radius: f32) {
        for (bin, other) in bins.directions.iter().enumerate() {
            let angle = middle.dot(*other).clamp(-1.0, 1.0).arc_cosine();
            let weight = (-2.0 * (angle / radius) * (angle / radius)).exponential();
            if weight > LEAST {
                self.bins.push(bin as u32);
                self.shares.push(weight);
            }
        }
    }

    /// The width for a sender of this solid angle, sr.
    pub fn width(bins: &Bins, solid_angle: f32) -> usize {
        let ratio = solid_angle / bins.solid_angle();
        // Twice the area, the next width.
        (0..WIDTHS - 1).take_while(|width| ratio > 1.414 * (1u32 << width) as f32).count()
    }

    /// Receiving bins and their shares.
    pub fn of(&self, count: usize, bin: usize, width: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        let row = width * count + bin;
        let range = self.offsets[row] as usize..self.offsets[row + 1] as usize;
        range.map(|at| (self.bins[at] as usize, self.shares[at]))
    }
}

/// Angular radius of the senders of a width.
fn radius(bins: &Bins, width: usize) -> f32 {
    let own = bins.sine().arc_sine();
    own * ((1u32 << width) as f32).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_to_one_and_wider_senders_reach_more_bins() {
        let bins = Bins::new(128);
        let spread = Spread::new(&bins);
        for bin in [0, 17, 64, 127] {
            let mut before = 0;
            for width in 0..WIDTHS {
                let row: Vec<_> = spread.of(128, bin, width).collect();
                let sum: f32 = row.iter().map(|cell| cell.1).sum();
                assert!(
                    (sum - 1.0).abs() < 1e-5 && row.len() >= before && row.iter().any(|cell| cell.0 == bin)
                );
                before = row.len();
            }
            assert!(before > 16);
        }
        let angle = bins.solid_angle();
        let widths = [0.5, 1.0, 2.0, 4.0, 1e6].map(|ratio| Spread::width(&bins, ratio * angle));
        assert_eq!(widths, [0, 0, 1, 2, WIDTHS - 1]);
    }
}
