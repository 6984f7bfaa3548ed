//! Neighbourhoods: receivers share gathered differences. On the finest levels a link is decided by
//! the weighted mean of the [differences](Difference) of receivers on the same surface.
//!
//! Light from a small lit patch reaches a receiver along few rays, so a single receiver's
//! difference is mostly noise, and a link from noise is a spot on a bare wall. The mean has a
//! fraction of the variance. The irradiance from a sender at distance d changes over a distance s
//! by about s / d of itself, by the split-sphere bound (Ward, Rubinstein and Clear 1988). Therefore
//! the neighbourhood is chosen per sender: no wider than a fifth of the sender's distance.

use crate::sampling::{Points, SurfacePoint};
use glam::Vec3;
use rebounce_shared::kernel::weight;

/// Least ratio of a sender's distance to the neighbourhood's radius.
const FAR: f32 = 5.0;
/// Number of neighbourhood radii: the support radius, halved up to `RADII` - 2 times, and the
/// receiver alone.
const RADII: usize = 4;
/// Least weight of a neighbour. A neighbour of lower weight costs as much and contributes little.
const LEAST_SHARED: f32 = 0.1;
/// Senders per block.
const BLOCK: usize = 32;
/// Mean hit distance, in support radii, from which a surface counts as fully bare.
const BARE: f32 = 50.0;
/// Factor on the noise threshold for bare surfaces, where a spot is visible, relative to surfaces
/// near details: on the finest level, and on coarser levels, where a spot is larger.
const STRICTER: [f32; 2] = [10.0, 20.0];

/// Gathered irradiance of a receiver from a sender minus the irradiance predicted by the parents'
/// values (Eq. 17).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Index of the sender.
    pub sender: u32,
    /// Irradiance per unit irradiance.
    pub amount: f32,
    /// The larger of minuend and subtrahend, in magnitude. The variance of `amount` is proportional
    /// to `magnitude`.
    pub magnitude: f32,
}

/// Gathered differences of a receiver.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Row {
    /// Sorted by sender, ascending.
    pub differences: Vec<Difference>,
    /// Harmonic mean distance of the hits, scene units.
    pub distance: f32,
}

impl Row {
    /// Sum of all differences.
    fn sum(&self) -> f32 {
        self.differences.iter().map(|difference| difference.amount).sum()
    }

    /// Factor on the noise threshold of links, 1 or more, for a receiver with this support radius,
    /// `above_finest` levels above the finest. Grows with the mean hit distance.
    pub fn strictness(&self, support: f32, above_finest: usize) -> f32 {
        let most = STRICTER[(above_finest > 0) as usize];
        1.0 + (most - 1.0) * (self.distance / (BARE * support)).min(1.0)
    }
}

/// Bounding spheres (centre, radius) of blocks of `BLOCK` consecutive senders. Consecutive senders
/// are close together.
#[derive(Clone, Debug, Default)]
pub struct SenderBlocks(Vec<(Vec3, f32)>);

impl SenderBlocks {
    /// Computes the bounding spheres of the first `count` points.
    pub fn new(points: &Points, count: usize) -> Self {
        let ball = |block: &[SurfacePoint]| {
            let of = |fold: fn(Vec3, Vec3) -> Vec3| block.iter().map(|p| p.position).reduce(fold);
            let (low, high) = (of(Vec3::min).unwrap_or_default(), of(Vec3::max).unwrap_or_default());
            (0.5 * (low + high), 0.5 * (high - low).length())
        };
        Self(points.points[..count].chunks(BLOCK).map(ball).collect())
    }
}

/// A receiver and its neighbours, with weights for averaging differences.
#[derive(Clone, Debug, Default)]
pub struct Neighbourhood {
    /// Row index and weights of each member; for each radius the weights sum to 1.
    members: Vec<(usize, [f32; RADII])>,
    /// Ratio of the variance of the mean to the variance of a single receiver, by radius.
    variances: [f32; RADII],
    /// Position of the receiver, local space.
    position: Vec3,
    /// Largest radius, scene units.
    support: f32,
}

impl Neighbourhood {
    /// Sets the neighbourhood to that of receiver `receivers[of]`, on a level with this support
    /// radius.
    pub fn gather(&mut self, points: &Points, receivers: &[usize], of: usize, support: f32) {
        let receiver = receivers[of];
        let point = &points.points[receiver];
        (self.position, self.support) = (point.position, support);
        self.members.clear();
        let is_hidden = |from: usize, way| points.cuts_of(from).iter().any(|cut| cut.ends(way));
        for (k, &other) in receivers.iter().enumerate() {
            let neighbour = &points.points[other];
            let way = neighbour.position - point.position;
            let weight =
                |radius| weight(way, neighbour.normal, point.normal, support / (1u32 << radius) as f32);
            if k == of {
                self.members.push((k, [1.0; RADII]));
            } else if neighbour.group == point.group
                && weight(0) > LEAST_SHARED
                && !is_hidden(receiver, way)
                && !is_hidden(other, -way)
            {
                let weight = |radius| if radius + 1 < RADII { weight(radius) } else { 0.0 };
                self.members.push((k, std::array::from_fn(weight)));
            }
        }
        for radius in 0..RADII {
            let total: f32 = self.members.iter().map(|(_, weights)| weights[radius]).sum();
            self.members.iter_mut().for_each(|(_, weights)| weights[radius] /= total);
            self.variances[radius] = self.members.iter().map(|(_, weights)| weights[radius].powi(2)).sum();
        }
    }

    /// Index of the radius for a sender at this position.
    #[inline]
    fn radius(&self, sender: Vec3) -> usize {
        let far = (FAR * self.support).powi(2);
        let distance = sender.distance_squared(self.position);
        (0..RADII - 1).find(|radius| distance >= far / (1u32 << (2 * radius)) as f32).unwrap_or(RADII - 1)
    }

    /// Visits the contribution of each member to the mean difference of each sender: sender,
    /// amount, and a factor of the mean's variance, per unit of variance of a single receiver.
    pub fn each(
        &self,
        points: &Points,
        blocks: &SenderBlocks,
        rows: &[Row],
        mut visit: impl FnMut(u32, f32, f32),
    ) {
        for &(row, weights) in &self.members {
            let (mut block, mut is_far) = (usize::MAX, false);
            for difference in &rows[row].differences {
                let sender = difference.sender as usize;
                if block != sender / BLOCK {
                    block = sender / BLOCK;
                    let (middle, reach) = blocks.0[block];
                    is_far = middle.distance(self.position) - reach >= FAR * self.support;
                }
                let radius = if is_far { 0 } else { self.radius(points.points[sender].position) };
                let weight = weights[radius];
                if weight > 0.0 {
                    let variance = weight * difference.magnitude * self.variances[radius];
                    visit(difference.sender, weight * difference.amount, variance);
                }
            }
        }
    }

    /// Mean of the members' sums over all senders, and the variance of the mean.
    pub fn sum(&self, rows: &[Row]) -> (f32, f32) {
        let mean: f32 = self.members.iter().map(|(row, weights)| weights[0] * rows[*row].sum()).sum();
        let deviation = |row: usize| (rows[row].sum() - mean).powi(2);
        let of_one: f32 = self.members.iter().map(|(row, weights)| weights[0] * deviation(*row)).sum();
        (mean, self.variances[0] * of_one)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::PointLevel;

    /// A grid of points on a floor, a point on the floor's underside, and a sender at a height
    /// above the centre.
    fn floor(height: f32) -> (Points, Vec<usize>, Vec<Row>) {
        let mut points: Vec<SurfacePoint> = (0..81)
            .map(|k| {
                let position = 0.1 * Vec3::new((k % 9) as f32, 0.0, (k / 9) as f32);
                SurfacePoint { position, normal: Vec3::Y, geometric_normal: Vec3::Y, group: 0 }
            })
            .collect();
        points.push(SurfacePoint { normal: Vec3::NEG_Y, geometric_normal: Vec3::NEG_Y, ..points[40] });
        points.push(SurfacePoint { position: points[40].position + height * Vec3::Y, ..points[81] });
        let level = PointLevel { first: 0, count: 82, disk_radius: 0.1, support_radius: 0.2 };
        let difference = |k: usize| Difference { sender: 82, amount: k as f32, magnitude: 1.0 };
        let row = |k| Row { differences: vec![difference(k)], distance: height };
        (
            Points { levels: vec![level], points, ..Points::default() },
            (0..82).collect(),
            (0..82).map(row).collect(),
        )
    }

    /// Members that share a sender at `height` above a receiver, and the remaining variance.
    fn shared(height: f32, of: usize) -> (Vec<usize>, f32) {
        let (points, receivers, mut rows) = floor(height);
        let (mut hood, blocks) = (Neighbourhood::default(), SenderBlocks::new(&points, 83));
        hood.gather(&points, &receivers, of, 0.2);
        let (mut total, mut left) = (0.0, 0.0);
        hood.each(&points, &blocks, &rows, |_, _, variance| left += variance);
        rows.iter_mut().for_each(|row| row.differences[0].amount = 1.0);
        hood.each(&points, &blocks, &rows, |_, amount, _| total += amount);
        assert!((total - 1.0).abs() < 1e-6, "weights sum to 1: {total}");
        let mut members = Vec::new();
        for k in 0..rows.len() {
            rows.iter_mut().for_each(|row| row.differences.clear());
            rows[k].differences = vec![Difference { sender: 82, amount: 1.0, magnitude: 1.0 }];
            hood.each(&points, &blocks, &rows, |_, _, _| members.push(k));
        }
        (members, left)
    }

    #[test]
    fn neighbours_on_the_same_surface_share_what_is_far() {
        let (members, variance) = shared(100.0, 40);
        assert_eq!(members, [30, 31, 32, 39, 40, 41, 48, 49, 50], "not the underside");
        // Between equal weights and a single receiver.
        assert!(variance > 1.0 / 9.0 && variance < 0.3, "{variance}");
        assert_eq!(shared(100.0, 81), (vec![81], 1.0));
    }

    #[test]
    fn what_is_near_is_shared_with_the_nearest_or_nobody() {
        assert_eq!(shared(0.6, 40), (vec![40], 1.0), "half the radius reaches none");
        assert_eq!(shared(0.1, 40), (vec![40], 1.0));
        // From five supports on the whole neighbourhood shares the sender; below, a neighbourhood
        // of half the radius.
        assert_eq!(shared(1.01, 40).0.len(), 9);
        assert_eq!(shared(0.99, 40).0.len(), 1);
    }

    #[test]
    fn bare_surfaces_are_tested_more_strictly() {
        let row = |distance| Row { distance, ..Row::default() };
        assert!(row(0.05).strictness(0.2, 0) < 1.1);
        assert_eq!(row(f32::INFINITY).strictness(0.2, 0), STRICTER[0]);
        assert_eq!(row(f32::INFINITY).strictness(0.2, 1), STRICTER[1]);
    }
}
