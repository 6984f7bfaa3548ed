//! Area of a patch by quadrature.

use super::Surface;
use glam::DVec2;

/// Places, from −1 to 1, and weights of the Gauss–Legendre rule of four places.
const RULE: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

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
            for (u, of_u) in RULE {
                for (v, of_v) in RULE {
                    let [_, along_u, along_v] = surface.derivatives(middle + half * DVec2::new(u, v));
                    sum += of_u * of_v * along_u.cross(along_v).length();
                }
            }
        }
    }
    half.x * half.y * sum
}
