//! Irradiance of a patch from one light, in cells as small as the refinement oracle asks for.

use super::basis::{Basis, Coefficients, MOST, Samples};
use super::cell::Cell;
use super::patch::{PatchPoint, PlacedPatch};
use super::settings::{Tolerance, WaveletSettings};
use super::tree::ReceivedTree;
use glam::{DVec2, DVec3};
use rebounce_cad::trim::Coverage;

/// Down to this level quarters are computed in parallel.
const PARALLEL_LEVELS: u32 = 3;

/// A patch that light falls on.
pub(super) struct PatchReceiver<'a, Light> {
    pub patch: &'a PlacedPatch<'a>,
    pub basis: &'a Basis,
    pub settings: &'a WaveletSettings,
    /// Irradiance of a point.
    pub light: Light,
    /// Greatest error of irradiance at control points.
    pub tolerance: Tolerance,
    /// Cells up to this level are divided in search of spots: light that falls on few of the control points
    /// of a large cell, or on none, would be lost more often than shadow.
    pub searched: u32,
}

impl<Light: Fn(&PatchPoint) -> DVec3 + Sync> PatchReceiver<'_, Light> {
    /// What falls on the patch; `None` if nothing does at any point looked at.
    ///
    /// The refinement oracle is that of Cuny et al. 2000: irradiance is computed at control points, here the
    /// Gauss points of a cell's quarters, and compared with the polynomial through the Gauss points of the
    /// cell. Where they differ the cell is divided, and the values at the control points are those of the
    /// quarters; where they agree the values make the cell's coefficients better.
    pub(super) fn receive(&self) -> Option<ReceivedTree> {
        let coverage = self.coverage(Coverage::Boundary, Cell::ROOT);
        let samples = self.samples(Cell::ROOT, coverage);
        self.divided(Cell::ROOT, coverage, &samples)
    }

    /// What falls on the patch, if that hardly matters: one cell, without control points.
    pub(super) fn receive_coarsely(&self) -> Option<ReceivedTree> {
        let coverage = self.coverage(Coverage::Boundary, Cell::ROOT);
        let samples = self.samples(Cell::ROOT, coverage);
        let is_dark = samples.iter().all(|sample| *sample == DVec3::ZERO);
        (!is_dark).then(|| ReceivedTree::Cell(Box::new(self.basis.project(&samples))))
    }

    /// What falls on the patch, if it is the same everywhere.
    pub(super) fn receive_in_the_middle(&self) -> Option<ReceivedTree> {
        let mut coefficients = Coefficients::default();
        coefficients[0] = (self.light)(&self.patch.middle);
        (coefficients[0] != DVec3::ZERO).then(|| ReceivedTree::Cell(Box::new(coefficients)))
    }

    fn coverage(&self, of_parent: Coverage, cell: Cell) -> Coverage {
        if of_parent == Coverage::Boundary { self.patch.mesh.coverage(cell.corners()) } else { of_parent }
    }

    /// Irradiance at the Gauss points of a cell.
    fn samples(&self, cell: Cell, coverage: Coverage) -> Samples {
        let mut samples = [DVec3::ZERO; MOST];
        for (index, sample) in samples.iter_mut().enumerate().take(self.basis.order().functions()) {
            let st = cell.at(self.basis.point(index).0);
            let is_plain = coverage == Coverage::Plain;
            let patch = self.patch;
            let point = if is_plain { patch.point(st) } else { patch.point_with_nearest(st, cell.side()) };
            *sample = (self.light)(&point);
        }
        samples
    }

    /// What falls on a cell with these values at its Gauss points; `None` for nothing.
    fn divided(&self, cell: Cell, coverage: Coverage, samples: &Samples) -> Option<ReceivedTree> {
        let coefficients = self.basis.project(samples);
        let area = self.patch.area * self.patch.mesh.density(cell.at(DVec2::splat(0.5))) * cell.area();
        let is_small = area < self.settings.min_cell_area;
        if coverage == Coverage::Empty || cell.level >= self.settings.max_level || is_small {
            let is_dark = samples.iter().all(|sample| *sample == DVec3::ZERO);
            return (!is_dark).then(|| ReceivedTree::Cell(Box::new(coefficients)));
        }
        let is_parallel = cell.level < PARALLEL_LEVELS;
        let quarters = four(is_parallel, |quadrant| {
            let child = cell.child(quadrant);
            let coverage = self.coverage(coverage, child);
            (coverage, self.samples(child, coverage))
        });
        let is_searched = cell.level < self.searched;
        let dark = |samples: &Samples| samples.iter().all(|sample| *sample == DVec3::ZERO);
        if !is_searched && dark(samples) && quarters.iter().all(|(_, samples)| dark(samples)) {
            return None;
        }
        let brightest = |samples: &Samples| samples.iter().map(|it| it.max_element()).fold(0.0, f64::max);
        let is_dim = quarters.iter().all(|(_, samples)| brightest(samples) <= self.tolerance.least);
        let is_coarse = cell.level < self.settings.min_level && !is_dim;
        let is_near = |quadrant: usize| self.is_near(&coefficients, quadrant, &quarters[quadrant].1);
        let is_smooth = !is_coarse && (0..4).all(is_near);
        if is_smooth && !is_searched {
            let finer = [0, 1, 2, 3].map(|quadrant: usize| self.basis.project(&quarters[quadrant].1));
            return Some(ReceivedTree::Cell(Box::new(self.basis.pull(&finer))));
        }
        let children = four(is_parallel, |quadrant| {
            let (coverage, samples) = &quarters[quadrant];
            self.divided(cell.child(quadrant), *coverage, samples)
        });
        if children.iter().all(Option::is_none) {
            return None;
        }
        let children = children.map(|child| child.unwrap_or_else(|| ReceivedTree::Cell(Box::default())));
        if is_smooth && let Some(undivided) = undivided(&children) {
            return Some(ReceivedTree::Cell(Box::new(self.basis.pull(&undivided))));
        }
        Some(ReceivedTree::Divided(Box::new(children)))
    }

    /// Whether a polynomial on a cell is as near to the values at the control points in a quarter as the
    /// tolerance asks for.
    fn is_near(&self, coefficients: &Coefficients, quadrant: usize, samples: &Samples) -> bool {
        let quarter = Cell::ROOT.child(quadrant);
        samples.iter().enumerate().take(self.basis.order().functions()).all(|(index, sample)| {
            let local = quarter.at(self.basis.point(index).0);
            let difference = self.basis.evaluate(coefficients, local) - *sample;
            difference.abs().max_element() <= self.tolerance.at(sample.max_element())
        })
    }
}

/// Coefficients of four cells, if none is divided.
fn undivided(cells: &[ReceivedTree; 4]) -> Option<[Coefficients; 4]> {
    let mut all = [Coefficients::default(); 4];
    for (coefficients, cell) in all.iter_mut().zip(cells) {
        let ReceivedTree::Cell(found) = cell else { return None };
        *coefficients = **found;
    }
    Some(all)
}

/// Something of four quadrants, perhaps in parallel.
fn four<T: Send>(is_parallel: bool, of: impl Fn(usize) -> T + Sync) -> [T; 4] {
    if !is_parallel {
        return [0, 1, 2, 3].map(of);
    }
    let ((a, b), (c, d)) =
        rayon::join(|| rayon::join(|| of(0), || of(1)), || rayon::join(|| of(2), || of(3)));
    [a, b, c, d]
}
