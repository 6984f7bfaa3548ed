//! Neighbourhoods of receivers share what their rays find: on the finest levels a link is decided by the weighted mean of the
//! [differences](Difference) of receivers on the same surface.
//!
//! Light from a small lit patch reaches a receiver along a few of its rays, so that most of one receiver's difference is
//! noise, and a link made of it is a spot on a bare wall. The mean has a fraction of the variance. The irradiance from a
//! sender at distance d changes over a distance s by about s / d of itself, by the split-sphere bound (Ward, Rubinstein and
//! Clear 1988). So each sender has a neighbourhood of its own: no wider than a fifth of its distance.

use crate::sampling::{Points, SurfacePoint};
use glam::Vec3;
use rebounce_shared::kernel::weight;

/// Least distance of a sender over the radius of the neighbourhood that shares it.
const FAR: f32 = 5.0;
/// Radii of neighbourhoods: the support, halved so many times less one; and the receiver alone.
const RADII: usize = 4;
/// Neighbours of less weight cost as much as others and bring little.
const LEAST_SHARED: f32 = 0.1;
/// Senders of a block.
const BLOCK: usize = 32;
/// Bare are surfaces that see what is at least so many support radii away.
const BARE: f32 = 50.0;
/// How much stricter the test against noise is on bare surfaces, where a spot shows, than in front of details: on the
/// finest level, and on coarser ones, where a spot is larger.
const STRICTER: [f32; 2] = [10.0, 20.0];

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

    /// How much stricter than elsewhere links must stand out of their noise, for a receiver of this support radius so many
    /// levels above the finest.
    pub fn strictness(&self, support: f32, above_finest: usize) -> f32 {
        let most = STRICTER[(above_finest > 0) as usize];
        1.0 + (most - 1.0) * (self.distance / (BARE * support)).min(1.0)
    }
}

/// Senders in blocks of consecutive ones, which lie together, and the balls that hold them.
#[derive(Clone, Debug, Default)]
pub struct SenderBlocks(Vec<(Vec3, f32)>);

impl SenderBlocks {
    /// Of the first `count` points.
    pub fn new(points: &Points, count: usize) -> Self {
        let ball = |block: &[SurfacePoint]| {
            let of = |fold: fn(Vec3, Vec3) -> Vec3| block.iter().map(|p| p.position).reduce(fold);
            let (low, high) = (of(Vec3::min).unwrap_or_default(), of(Vec3::max).unwrap_or_default());
            (0.5 * (low + high), 0.5 * (high - low).length())
        };
        Self(points.points[..count].chunks(BLOCK).map(ball).collect())
    }
}

/// A receiver and its neighbours.
#[derive(Clone, Debug, Default)]
pub struct Neighbourhood {
    /// Row and weights of each; the weights of each radius sum to 1.
    members: Vec<(usize, [f32; RADII])>,
    /// The variance of the mean over that of one receiver, by radius.
    variances: [f32; RADII],
    /// The receiver's position, local space.
    position: Vec3,
    /// The largest radius, scene units.
    support: f32,
}

impl Neighbourhood {
    /// Makes it that of a receiver: entry `of` of `receivers`, of a level of this support radius.
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
            } else if weight(0) > LEAST_SHARED && !is_hidden(receiver, way) && !is_hidden(other, -way) {
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

    /// Which radius a sender at this place has.
    #[inline]
    fn radius(&self, sender: Vec3) -> usize {
        let far = (FAR * self.support).powi(2);
        let distance = sender.distance_squared(self.position);
        (0..RADII - 1).find(|radius| distance >= far / (1u32 << (2 * radius)) as f32).unwrap_or(RADII - 1)
    }

    /// Visits what each member contributes to the mean difference of each sender: sender, amount, and what the variance of
    /// the mean goes with, per unit of variance of one receiver.
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

    /// The mean of the members' sums over all senders, and its variance.
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

    /// A grid of points on a floor, one more on its underside, and one more, the sender, at a height over the middle.
    fn floor(height: f32) -> (Points, Vec<usize>, Vec<Row>) {
        let mut points: Vec<SurfacePoint> = (0..81)
            .map(|k| {
                let position = 0.1 * Vec3::new((k % 9) as f32, 0.0, (k / 9) as f32);
                SurfacePoint { position, normal: Vec3::Y, geometric_normal: Vec3::Y }
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

    /// Who shares a sender so high over a receiver with it, and the variance that is left.
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
        // Between alike weights and one receiver alone.
        assert!(variance > 1.0 / 9.0 && variance < 0.3, "{variance}");
        assert_eq!(shared(100.0, 81), (vec![81], 1.0));
    }

    #[test]
    fn what_is_near_is_shared_with_the_nearest_or_nobody() {
        assert_eq!(shared(0.6, 40), (vec![40], 1.0), "half the radius reaches none");
        assert_eq!(shared(0.1, 40), (vec![40], 1.0));
        // At five supports the whole neighbourhood shares it, under it half as wide a one.
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
