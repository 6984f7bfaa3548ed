//! Areas on the surface where the map to the square does not keep them: by natural parameters.

use super::equal_area::area_element;
use super::{VirtualMesh, VirtualMeshError};
use crate::trim::Coverage;
use glam::DVec2;

/// Cells with greater sides are divided before quadrature.
const SIDE: f64 = 1.0 / 128.0;

impl VirtualMesh {
    /// The area element at a point of the square, as a multiple of its mean over the square: exactly 1 where
    /// areas keep their proportions.
    pub fn density(&self, st: DVec2) -> f64 {
        self.mean_element.map_or(1.0, |mean| area_element(&self.surface, self.parameters(st)) / mean)
    }

    /// Whether areas keep their proportions, so that the density is 1 everywhere.
    pub fn is_equal_area(&self) -> bool {
        self.mean_element.is_none()
    }

    /// Mean over a cell of the density at its real points and 0 at the others: the real area on the surface
    /// per area of the square. Where the density is 1, the part of the cell that is real.
    ///
    /// In cells with sides of 1/128 at most, the density at the centroid of the real part stands for all of
    /// it: exact for linear ones.
    pub fn real_density(&self, cell: [DVec2; 2]) -> f64 {
        match self.mean_element {
            None => self.real_part_of_square(cell),
            Some(mean) => self.mean_element_of(cell, self.coverage(cell)) / mean,
        }
    }

    /// Mean density over all of a cell.
    pub(super) fn mean_density(&self, cell: [DVec2; 2]) -> f64 {
        self.mean_element.map_or(1.0, |mean| self.mean_element_of(cell, Coverage::Plain) / mean)
    }

    /// Finds the mean area element, if the map does not keep areas.
    pub(super) fn measure(&mut self) -> Result<(), VirtualMeshError> {
        if self.map.keeps_areas() {
            return Ok(());
        }
        let mean = self.mean_element_of([DVec2::ZERO, DVec2::ONE], Coverage::Plain);
        self.mean_element = Some(mean);
        if mean > 0.0 && mean.is_finite() { Ok(()) } else { Err(VirtualMeshError::NoArea) }
    }

    /// Mean over a cell of the area element at real points, 0 at others.
    fn mean_element_of(&self, cell: [DVec2; 2], coverage: Coverage) -> f64 {
        if coverage == Coverage::Empty {
            return 0.0;
        }
        let [low, high] = cell;
        let side = 0.5 * (high - low);
        if 2.0 * side.max_element() > SIDE {
            let quarter = |i: u32| {
                let from = low + side * DVec2::new(f64::from(i % 2), f64::from(i / 2));
                let cell = [from, from + side];
                let of_quarter = if coverage == Coverage::Plain { coverage } else { self.coverage(cell) };
                self.mean_element_of(cell, of_quarter)
            };
            return 0.25 * (0..4).map(quarter).sum::<f64>();
        }
        let is_plain = coverage == Coverage::Plain;
        let (share, centroid) = if is_plain { (1.0, low + side) } else { self.real_part(cell) };
        if share > 0.0 { share * area_element(&self.surface, self.parameters(centroid)) } else { 0.0 }
    }
}
