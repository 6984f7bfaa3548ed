//! Neighbouring receivers share what their rays find: on the finest levels a link is chosen from the mean of the
//! [differences](Difference) of receivers on the same surface.
//!
//! Light from a small lit patch reaches a receiver along a few of its rays, so that most of one receiver's difference is
//! noise, and a link made of it is a spot on a bare wall. The mean over a neighbourhood has a fraction of the variance.
//! Neighbourhoods are no wider than what a receiver sees is far away: by the split-sphere bound (Ward, Rubinstein and Clear
//! 1988) irradiance changes over a distance by at most about that distance over the harmonic mean distance of what is seen.

use crate::points::Points;
use rebounce_shared::kernel::weight;

/// Radius of a neighbourhood over the [harmonic mean distance](super::found::Found::distance), at most.
const NEAR: f32 = 0.2;
/// Bare are surfaces that see what is at least so many support radii away.
const BARE: f32 = 50.0;
/// How much stricter the test against noise is on bare surfaces, where a spot shows, than in front of details.
const STRICTER: f32 = 10.0;

/// What a receiver gets from a sender less what coarser receivers expect it to get (Eq. 17).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// The sender.
    pub sender: u32,
    /// Irradiance per unit irradiance.
    pub amount: f32,
    /// The larger of what is subtracted from each other: the variance of `amount` goes with it.
    pub magnitude: f32,
}

/// What the rays of one receiver find.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// By sender, ascending.
    pub differences: Vec<Difference>,
    /// The harmonic mean distance of what it sees, scene units.
    pub distance: f32,
}

impl Row {
    /// All differences together.
    fn sum(&self) -> f32 {
        self.differences.iter().map(|difference| difference.amount).sum()
    }

    /// How much stricter than elsewhere links must stand out of their noise, for a receiver of this support radius.
    pub fn strictness(&self, support: f32) -> f32 {
        1.0 + (STRICTER - 1.0) * (self.distance / (BARE * support)).min(1.0)
    }
}

/// Appends the neighbourhood of a receiver to `pool`, itself included: which of `receivers`, and its weight; weights sum to
/// 1. `rows` are those of `receivers`, `support` is the level's support radius.
pub fn neighbourhood(
    points: &Points,
    receivers: &[usize],
    rows: &[Row],
    of: usize,
    support: f32,
    pool: &mut Vec<(usize, f32)>,
) {
    pool.clear();
    let (receiver, reach) = (receivers[of], support.min(NEAR * rows[of].distance));
    let point = &points.points[receiver];
    for (k, &other) in receivers.iter().enumerate() {
        let neighbour = &points.points[other];
        let offset = neighbour.position - point.position;
        if k != of && offset.length_squared() >= reach * reach {
            continue;
        }
        let radius = reach.min(NEAR * rows[k].distance).max(f32::MIN_POSITIVE);
        let weight = if k == of { 1.0 } else { weight(offset, neighbour.normal, point.normal, radius) };
        let is_hidden = |from: usize, offset| points.cuts_of(from).iter().any(|cut| cut.ends(offset));
        if weight > 0.0 && (k == of || !is_hidden(receiver, offset) && !is_hidden(other, -offset)) {
            pool.push((k, weight));
        }
    }
    let total: f32 = pool.iter().map(|entry| entry.1).sum();
    pool.iter_mut().for_each(|entry| entry.1 /= total);
}

/// The variance of the sum of a row, from those of a neighbourhood.
pub fn sum_variance(pool: &[(usize, f32)], rows: &[Row]) -> f32 {
    let mean: f32 = pool.iter().map(|(k, weight)| weight * rows[*k].sum()).sum();
    pool.iter().map(|(k, weight)| weight * (rows[*k].sum() - mean).powi(2)).sum()
}

/// The variance of a neighbourhood's mean over that of one receiver.
pub fn variance(pool: &[(usize, f32)]) -> f32 {
    pool.iter().map(|entry| entry.1 * entry.1).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::points::{PointLevel, SurfacePoint};
    use glam::Vec3;

    /// A grid of points on a floor, one more on its underside, and their rows.
    fn floor(distance: f32) -> (Points, Vec<usize>, Vec<Row>) {
        let mut points: Vec<SurfacePoint> = (0..81)
            .map(|k| {
                let position = 0.1 * Vec3::new((k % 9) as f32, 0.0, (k / 9) as f32);
                SurfacePoint { position, normal: Vec3::Y, geometric_normal: Vec3::Y }
            })
            .collect();
        points.push(SurfacePoint { normal: Vec3::NEG_Y, geometric_normal: Vec3::NEG_Y, ..points[40] });
        let level = PointLevel { first: 0, count: 82, disk_radius: 0.1, support_radius: 0.2 };
        let receivers: Vec<usize> = (0..82).collect();
        let rows = vec![Row { differences: Vec::new(), distance }; 82];
        (Points { levels: vec![level], points, ..Points::default() }, receivers, rows)
    }

    #[test]
    fn neighbours_on_the_same_surface_share() {
        let (points, receivers, rows) = floor(100.0);
        let mut pool = Vec::new();
        neighbourhood(&points, &receivers, &rows, 40, 0.2, &mut pool);
        assert!(pool.iter().all(|entry| entry.0 != 81), "the underside");
        assert_eq!(pool.len(), 9);
        assert!((pool.iter().map(|entry| entry.1).sum::<f32>() - 1.0).abs() < 1e-6);
        // Between alike weights and one receiver alone.
        assert!(variance(&pool) > 1.0 / 9.0 && variance(&pool) < 0.3, "{}", variance(&pool));
        neighbourhood(&points, &receivers, &rows, 81, 0.2, &mut pool);
        assert_eq!(pool, [(81, 1.0)]);
    }

    #[test]
    fn what_is_near_is_not_shared_and_tested_as_elsewhere() {
        let (points, receivers, rows) = floor(0.05);
        let mut pool = Vec::new();
        neighbourhood(&points, &receivers, &rows, 40, 0.2, &mut pool);
        assert_eq!(pool, [(40, 1.0)]);
        assert!(rows[40].strictness(0.2) < 1.1);
        assert_eq!(Row { distance: f32::INFINITY, ..Row::default() }.strictness(0.2), STRICTER);
    }
}
