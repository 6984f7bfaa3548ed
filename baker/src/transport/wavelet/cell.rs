//! Cells of the quadtree of a unit square.

use glam::DVec2;

/// A square of a level of the quadtree over the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    /// 0 is the whole square; each level halves the sides.
    pub level: u32,
    x: u32,
    y: u32,
}

impl Cell {
    /// The whole unit square.
    pub(super) const ROOT: Self = Self { level: 0, x: 0, y: 0 };

    /// A quarter. Quadrant 1 is that of greater s, 2 that of greater t.
    pub(super) fn child(self, quadrant: usize) -> Self {
        let [x, y] = [quadrant % 2, quadrant / 2].map(|half| half as u32);
        Self { level: self.level + 1, x: 2 * self.x + x, y: 2 * self.y + y }
    }

    /// Side.
    pub(super) fn side(self) -> f64 {
        0.5_f64.powi(self.level as i32)
    }

    /// Area, the whole square's being 1.
    pub(super) fn area(self) -> f64 {
        self.side() * self.side()
    }

    /// From a point in the cell, 0 to 1, to one of the square.
    pub(super) fn at(self, local: DVec2) -> DVec2 {
        self.side() * (DVec2::new(f64::from(self.x), f64::from(self.y)) + local)
    }

    /// From a point of the square to one in the cell, 0 to 1.
    pub(super) fn local(self, st: DVec2) -> DVec2 {
        st / self.side() - DVec2::new(f64::from(self.x), f64::from(self.y))
    }

    /// Least and greatest corner.
    pub(super) fn corners(self) -> [DVec2; 2] {
        [self.at(DVec2::ZERO), self.at(DVec2::ONE)]
    }
}

/// The quadrant of a point of a cell, 0 to 1, and where it is in that quarter.
pub(super) fn descend(local: DVec2) -> (usize, DVec2) {
    let halves = [local.x >= 0.5, local.y >= 0.5].map(usize::from);
    let corner = DVec2::new(halves[0] as f64, halves[1] as f64);
    (halves[0] + 2 * halves[1], 2.0 * local - corner)
}
