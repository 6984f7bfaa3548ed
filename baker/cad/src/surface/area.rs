//! Area of a patch by quadrature.

use super::Surface;
use crate::quadrature::GAUSS_4;
use glam::DVec2;

/// ∫ |σᵤ × σᵥ| over the patch, by Gauss–Legendre quadrature in 2 × 2, 4 × 4, … 64 × 64 cells until it changes by less than 1e-7 of it.
pub(super) fn integral(surface: &Surface, patch: [DVec2; 2]) -> f64 {
    let mut coarse = in_cells(surface, patch, 2);
    for cells in [4, 8, 16, 32, 64] {
        let fine = in_cells(surface, patch, cells);
        if (fine - coarse).abs() <= 1e-7 * fine {
            return fine;
        }
        coarse = fine;
    }
    coarse
}

/// The rule in `cells` × `cells` equal cells.
fn in_cells(surface: &Surface, [low, high]: [DVec2; 2], cells: u32) -> f64 {
    let half = 0.5 * (high - low) / f64::from(cells);
    let mut sum = 0.0;
    for i in 0..cells {
        for j in 0..cells {
            let middle = low + half * DVec2::new(f64::from(2 * i + 1), f64::from(2 * j + 1));
            for (u, of_u) in GAUSS_4 {
                for (v, of_v) in GAUSS_4 {
                    let [_, along_u, along_v] = surface.derivatives(middle + half * DVec2::new(u, v));
                    sum += of_u * of_v * along_u.cross(along_v).length();
                }
            }
        }
    }
    half.x * half.y * sum
}
