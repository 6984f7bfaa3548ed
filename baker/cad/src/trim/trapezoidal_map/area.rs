//! Areas of trimmed domains.

use super::{MonotoneEdge, TrapezoidalMap, sort_key};
use glam::{DVec2, DVec3};

/// Nodes from −1 to 1 and weights of the Gauss–Legendre rule of five nodes.
const RULE: [(f64, f64); 5] = [
    (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
    (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.0, 128.0 / 225.0),
    (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
    (0.906_179_845_938_664, 0.236_926_885_056_189_08),
];

impl TrapezoidalMap {
    /// Area in the parameter plane, by closed forms of segments and elliptic arcs. Takes O(n²) where many
    /// pieces are long.
    pub fn area(&self) -> f64 {
        let origin = 0.5 * (self.bounds[0].y + self.bounds[1].y);
        let mut area = 0.0;
        let mut next = 0;
        let mut active: Vec<(f64, usize)> = Vec::new();
        for slab in self.lines.windows(2) {
            active.retain(|&(_, piece)| self.pieces[piece].u[1] > slab[0]);
            while self.pieces.get(next).is_some_and(|piece| piece.u[0] <= slab[0]) {
                active.push((0.0, next));
                next += 1;
            }
            for (order, piece) in &mut active {
                *order = sort_key(&self.pieces[*piece], slab[0], slab[1]);
            }
            active.sort_by(|a, b| a.0.total_cmp(&b.0));
            for (i, &(_, piece)) in active.iter().enumerate() {
                let integral = self.pieces[piece].integral(slab[0], slab[1], origin);
                area += if i % 2 == 1 { integral } else { -integral };
            }
        }
        area
    }

    /// Area of the domain within a patch from the least to the greatest u and v. O(s n log n) at most where
    /// the patch spans s slabs.
    pub fn area_within(&self, patch: [DVec2; 2]) -> f64 {
        let strip = [patch[0].y, patch[1].y];
        self.sum_within(patch, |piece, range| DVec3::X * piece.clamped_integral(range, strip)).x
    }

    /// ∫ u and ∫ v over the part of the domain within a patch: the centroid times the area. Exact for
    /// segments, to a part in a thousand for arcs.
    pub fn moments_within(&self, patch: [DVec2; 2]) -> DVec2 {
        let [low, high] = [patch[0].y, patch[1].y];
        let below = |piece: &MonotoneEdge, [a, b]: [f64; 2]| {
            let [from, to] = piece.within([a, b], [low, high]);
            let mut sum = DVec3::ZERO;
            for [a, b] in [[a, from], [from, to], [to, b]] {
                for (node, weight) in RULE {
                    // u = a + (b − a) (3 x² − 2 x³): an arc's vertical ends are smooth in x.
                    let x = 0.5 * (1.0 + node);
                    let u = a + (b - a) * x * x * (3.0 - 2.0 * x);
                    let weight = 0.5 * weight * 6.0 * x * (1.0 - x) * (b - a);
                    let v = piece.v_at(u).clamp(low, high);
                    sum += weight * (v - low) * DVec3::new(0.0, u, 0.5 * (v + low));
                }
            }
            sum
        };
        let sum = self.sum_within(patch, below);
        DVec2::new(sum.y, sum.z)
    }

    /// The alternating sum, in each slab, of something of the pieces between two u.
    fn sum_within(&self, patch: [DVec2; 2], of: impl Fn(&MonotoneEdge, [f64; 2]) -> DVec3) -> DVec3 {
        let [low, high] = patch;
        let slabs = self.lines.len().saturating_sub(1);
        let begin = self.lines.partition_point(|&line| line <= low.x).saturating_sub(1);
        let end = self.lines.partition_point(|&line| line < high.x).min(slabs);
        let mut sum = DVec3::ZERO;
        let mut entries: Vec<(f64, u32)> = Vec::new();
        for slab in begin..end {
            let [left, right] = [self.lines[slab], self.lines[slab + 1]];
            let range = [left.max(low.x), right.min(high.x)];
            if range[0] >= range[1] {
                continue;
            }
            let key = |&entry: &u32| (sort_key(&self.pieces[entry as usize], left, right), entry);
            entries.clear();
            entries.extend(self.levels.iter().flat_map(|level| level.node(slab)).map(key));
            entries.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for (i, &(_, entry)) in entries.iter().enumerate() {
                let part = of(&self.pieces[entry as usize], range);
                sum += if i % 2 == 1 { part } else { -part };
            }
        }
        sum
    }
}
