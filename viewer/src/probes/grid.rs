//! A regular grid of probes.

use glam::Vec3;

/// Greatest number of probes of a grid whose spacing is not given.
pub const MOST: usize = 1000;
/// Greatest number of probes of any grid.
pub const LIMIT: usize = 1 << 14;

/// A grid of probes, local space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Place of the first probe.
    pub first: Vec3,
    /// Distance of neighbours along every axis, scene units.
    pub spacing: f32,
    /// Probes along x, y and z; x varies fastest.
    pub counts: [u32; 3],
}

impl Grid {
    /// A grid over a box: half a spacing within, or in the middle of an axis that is shorter. Without a spacing, the
    /// least that gives at most [`MOST`] probes; a spacing that gives more than [`LIMIT`] is widened.
    pub fn covering([low, high]: [Vec3; 2], spacing: Option<f32>) -> Self {
        let size = (high - low).max(Vec3::ZERO);
        let counts = |spacing: f32| (size / spacing).round().max(Vec3::ONE);
        let (mut width, most) = match spacing {
            Some(spacing) => (spacing, LIMIT),
            // With a single probe an axis at the start.
            None => (0.02 * size.max_element().max(f32::MIN_POSITIVE), MOST),
        };
        while counts(width).element_product() > most as f32 {
            width *= 1.02;
        }
        let counts = counts(width);
        let first = low + 0.5 * (size - (counts - 1.0) * width);
        Self { first, spacing: width, counts: counts.to_array().map(|count| count as u32) }
    }

    /// Number of probes.
    pub fn len(&self) -> usize {
        self.counts.iter().map(|count| *count as usize).product()
    }

    /// Whether there are none: never.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Place of a probe in the grid, before it is moved out of a wall.
    pub fn place(&self, probe: usize) -> Vec3 {
        let [x, y, _] = self.counts.map(|count| count as usize);
        let at = [probe % x, probe / x % y, probe / (x * y)].map(|i| i as f32);
        self.first + Vec3::from(at) * self.spacing
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_lies_within_its_box_and_has_no_more_probes_than_allowed() {
        for size in
            [Vec3::ONE, Vec3::new(30.0, 12.0, 18.0), Vec3::new(4.0, 2.5, 0.01), Vec3::new(500.0, 3.0, 3.0)]
        {
            let low = Vec3::new(-1.0, 2.0, 7.0);
            for spacing in [None, Some(0.5), Some(1e-4)] {
                let grid = Grid::covering([low, low + size], spacing);
                assert!((1..=LIMIT).contains(&grid.len()) && (spacing.is_some() || grid.len() <= MOST));
                let ends = [grid.place(0), grid.place(grid.len() - 1)];
                assert!(
                    ends[0].cmpge(low - 1e-3).all() && ends[1].cmple(low + size + 1e-3).all(),
                    "{grid:?}"
                );
                let middle = 0.5 * (ends[0] + ends[1]) - (low + 0.5 * size);
                assert!(middle.abs().max_element() < 1e-3 * size.max_element());
            }
        }
    }
}
