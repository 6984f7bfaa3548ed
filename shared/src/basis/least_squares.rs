//! Parent weights for linear interpolation: moving least squares of degree 1 (Lancaster and Salkauskas 1981), kept
//! positive.
//!
//! Shepard's weights w_k / Σ w reproduce constants. Along a gradient they make terraces: plateaus at the parents'
//! values with steep changes in between, a wave with the period of the parent spacing. Moving least squares reproduce
//! linear functions, too:
//!
//! ```text
//! p_k = w_k / Σ w · (1 − s (d_k − d̄)ᵀ C⁻¹ d̄),   d̄ = Σ w d / Σ w,   C = Σ w (d − d̄)(d − d̄)ᵀ / Σ w + μ tr(C) I
//! ```
//!
//! with `d_k` the offset from the point to parent k in the point's tangent plane. μ bounds C⁻¹ for collinear parents.
//! s is 1 if no weight would become negative, as with parents all around the point; s is smaller at the rim of a
//! surface.

use glam::{Vec2, Vec3};

/// μ.
const RIDGE: f32 = 0.01;
/// Maximum share of its weight that a parent may lose.
const MOST_LOST: f32 = 0.95;
/// Least ratio of tr(C) to the square of d̄: coincident parents have no slope.
const LEAST_SPREAD: f32 = 1e-4;

/// Makes the weights of a row of parents linear at a point with this unit normal. `way` returns the offset from the
/// point to a parent, scene units. The sum of the weights and the order of the row do not change.
pub fn make_linear(normal: Vec3, row: &mut [(u32, f32)], way: impl Fn(u32) -> Vec3) {
    let total: f32 = row.iter().map(|entry| entry.1).sum();
    if row.len() < 2 || total <= 0.0 {
        return;
    }
    let (tangent, bitangent) = normal.any_orthonormal_pair();
    let flat = |parent: u32| {
        let way = way(parent);
        Vec2::new(way.dot(tangent), way.dot(bitangent))
    };
    let mean = row.iter().fold(Vec2::ZERO, |sum, entry| sum + flat(entry.0) * entry.1) / total;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for &(parent, weight) in row.iter() {
        let d = flat(parent) - mean;
        xx += weight * d.x * d.x;
        xy += weight * d.x * d.y;
        yy += weight * d.y * d.y;
    }
    let trace = xx + yy;
    if trace <= LEAST_SPREAD * total * mean.length_squared() {
        return;
    }
    xx += RIDGE * trace;
    yy += RIDGE * trace;
    let determinant = xx * yy - xy * xy;
    let tilt = Vec2::new(yy * mean.x - xy * mean.y, xx * mean.y - xy * mean.x) * (total / determinant);
    let lost = |parent: u32| (flat(parent) - mean).dot(tilt);
    let most = row.iter().fold(0f32, |most, entry| most.max(lost(entry.0)));
    let scale = if most > MOST_LOST { MOST_LOST / most } else { 1.0 };
    for (parent, weight) in row {
        *weight *= 1.0 - scale * lost(*parent);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Parents around the origin, in a plane across `normal`, with weights of their own.
    fn row(count: u32) -> Vec<(u32, f32)> {
        (0..count).map(|k| (k, 0.2 + 0.3 * (k % 3) as f32)).collect()
    }

    fn way(normal: Vec3, parent: u32) -> Vec3 {
        let (t, b) = normal.any_orthonormal_pair();
        let angle = 2.4 * parent as f32;
        let length = 0.5 + 0.4 * (1.7 * parent as f32).sin();
        length * (t * angle.cos() + b * angle.sin()) + 0.01 * normal
    }

    #[test]
    fn linear_functions_are_reproduced_among_parents_all_around() {
        for normal in [Vec3::Y, Vec3::new(0.6, 0.0, -0.8)] {
            let mut row = row(9);
            let before: f32 = row.iter().map(|entry| entry.1).sum();
            let mean = |row: &[(u32, f32)]| -> Vec3 {
                row.iter().map(|(k, weight)| way(normal, *k) * *weight).sum::<Vec3>() / before
            };
            let shepard = mean(&row).reject_from(normal).length();
            make_linear(normal, &mut row, |k| way(normal, k));
            let linear = mean(&row).reject_from(normal).length();
            assert!(linear < 0.03 * shepard, "{linear} and {shepard}");
            let after: f32 = row.iter().map(|entry| entry.1).sum();
            assert!((after - before).abs() < 1e-5 && row.iter().all(|entry| entry.1 > 0.0));
        }
    }

    #[test]
    fn weights_stay_positive_at_a_rim_and_where_parents_stand_in_a_line() {
        let beside = |k: u32| Vec3::new(1.0 + 0.3 * k as f32, 0.0, 0.2 * (k % 2) as f32);
        let line = |k: u32| Vec3::new(0.5 * k as f32 - 0.7, 0.0, 0.0);
        let one = |_: u32| Vec3::new(0.3, 0.0, 0.1);
        let places: [&dyn Fn(u32) -> Vec3; 3] = [&beside, &line, &one];
        for place in places {
            let mut tilted = row(5);
            make_linear(Vec3::Y, &mut tilted, place);
            let sum: f32 = tilted.iter().map(|entry| entry.1).sum();
            let before: f32 = row(5).iter().map(|entry| entry.1).sum();
            assert!((sum - before).abs() < 1e-4 * before, "{sum}");
            assert!(tilted.iter().all(|entry| entry.1 > 0.0 && entry.1.is_finite()), "{tilted:?}");
        }
    }
}
