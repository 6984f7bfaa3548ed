//! Bézier patches cut into pieces that are nearly flat: their boxes are tight, and Newton's iteration begins near the root.

use crate::spline::BezierPatch;
use glam::DVec3;

/// Greatest distance of inner control points from where they would lie on a bilinear patch of the same corners, in multiples of the
/// piece's size.
const FLAT: f64 = 0.05;
/// Most halvings of a patch.
const DEEPEST: u32 = 6;
/// Beyond so many pieces of a face, patches are left whole.
const MOST_PIECES: usize = 4096;

/// Pieces of the patches of a face, each with the number of its patch.
pub(super) fn flattened(patches: Vec<BezierPatch>) -> Vec<(usize, BezierPatch)> {
    let room = (MOST_PIECES / patches.len().max(1)).max(1);
    let deepest = room.ilog2().min(DEEPEST);
    let mut pieces = Vec::new();
    for (number, patch) in patches.into_iter().enumerate() {
        let mut waiting = vec![(patch, 0)];
        while let Some((piece, depth)) = waiting.pop() {
            match bent(&piece) {
                Some(direction) if depth < deepest => {
                    waiting.extend(piece.halves(direction).map(|half| (half, depth + 1)));
                }
                _ => pieces.push((number, piece)),
            }
        }
    }
    pieces
}

/// The direction in which a patch is bent most, u (0) or v (1); `None` if it is nearly flat.
fn bent(patch: &BezierPatch) -> Option<usize> {
    let [p, q] = patch.degrees;
    let place = |i: usize, j: usize| patch.pole(i * (q + 1) + j);
    // From the chord of a row or column.
    let aside = |ends: [DVec3; 2], inner: DVec3, index: usize, degree: usize| {
        ends[0].lerp(ends[1], index as f64 / degree as f64).distance(inner)
    };
    let mut most = [0.0_f64; 2];
    for i in 0..=p {
        for j in 0..=q {
            most[0] = most[0].max(aside([place(0, j), place(p, j)], place(i, j), i, p));
            most[1] = most[1].max(aside([place(i, 0), place(i, q)], place(i, j), j, q));
        }
    }
    let [low, high] = patch.bounds();
    let direction = usize::from(most[1] > most[0]);
    (most[direction] > FLAT * (high - low).length()).then_some(direction)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spline::patches;
    use crate::spline::samples::{sphere, wavy};

    #[test]
    fn pieces_cover_their_patch_and_are_flat() {
        for surface in [sphere(2.0), wavy(6)] {
            let patches = patches(&surface);
            let pieces = flattened(patches.clone());
            for (number, patch) in patches.iter().enumerate() {
                let area = |patch: &BezierPatch| (patch.range[1] - patch.range[0]).element_product();
                let of_patch: Vec<_> = pieces.iter().filter(|piece| piece.0 == number).collect();
                let covered: f64 = of_patch.iter().map(|piece| area(&piece.1)).sum();
                assert!((covered / area(patch) - 1.0).abs() < 1e-12);
                // Those that are not flat are as small as pieces get.
                let least = area(patch) / f64::from(1 << DEEPEST);
                let is_done = |piece: &BezierPatch| bent(piece).is_none() || area(piece) < 1.01 * least;
                assert!(of_patch.iter().all(|(_, piece)| is_done(piece)));
            }
            assert!(pieces.len() > patches.len());
        }
    }
}
