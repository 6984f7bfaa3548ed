//! Tree over emissive triangles, for next-event estimation with many emitters.
//!
//! A binary tree with bounds, power and normal cone per node (Conty Estevez and Kulla 2018, "Importance Sampling of Many
//! Lights with Adaptive Tree Splitting"). A receiver's samples are divided between the children of a node in proportion to
//! their importance, by systematic sampling: every triangle gets its share of the samples rounded up or down.

use crate::geometry::{EmissiveTriangle, Emitters};
use crate::random::Stream;
use glam::Vec3;
use rebounce_shared::elementary::Elementary;

/// A node. Children of an inner node are neighbours: `first` and `first + 1`.
#[derive(Clone, Copy, Debug)]
struct EmitterNode {
    low: Vec3,
    high: Vec3,
    /// Area times mean radiance, summed over channels.
    power: f32,
    /// Mean front normal, and the cosine of the largest angle between it and a normal; −1 for two-sided triangles.
    axis: Vec3,
    cos_spread: f32,
    /// Index of the first child; of a leaf, the number of the emitter.
    first: u32,
    is_leaf: bool,
}

/// A triangle with samples assigned by [`EmitterTree::assign`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Assigned {
    /// Number of the emitter.
    pub emitter: u32,
    /// Number of samples.
    pub samples: u32,
    /// Expected number of samples: the weight of a sample is its reciprocal.
    pub expected: f32,
}

/// Tree over the emissive triangles of surfaces.
pub struct EmitterTree {
    nodes: Vec<EmitterNode>,
}

/// Input of the build: a triangle's leaf, and its centre.
struct Leaf {
    node: EmitterNode,
    centre: Vec3,
}

impl EmitterTree {
    /// Builds the tree of the emitters with these numbers; empty without.
    pub fn new(emitters: &dyn Emitters, numbers: impl Iterator<Item = u32>) -> Self {
        let leaf = |number: u32| {
            let emitter = emitters.emitter(number);
            Leaf { node: leaf_of(&emitter, number), centre: emitter.corners.iter().sum::<Vec3>() / 3.0 }
        };
        let mut leaves: Vec<Leaf> = numbers.map(leaf).collect();
        let mut nodes = Vec::with_capacity(2 * leaves.len());
        if !leaves.is_empty() {
            nodes.push(leaves[0].node);
            build(&mut nodes, 0, &mut leaves);
        }
        Self { nodes }
    }

    /// Divides `samples` between the triangles by their importance at a receiver with unit normal; triangles without
    /// samples are left out.
    pub fn assign(
        &self,
        position: Vec3,
        normal: Vec3,
        samples: u32,
        stream: &mut Stream,
        out: &mut Vec<Assigned>,
    ) {
        out.clear();
        // A node takes an interval of 0 to `samples`, and the samples in it: one lies at each whole number less an offset.
        let offset = stream.unit();
        let count = |[low, high]: [f32; 2]| {
            ((high + offset) as u32).min(samples) - ((low + offset) as u32).min(samples)
        };
        let mut stack = smallvec::SmallVec::<[(u32, [f32; 2]); 64]>::new();
        if self.nodes.first().is_some_and(|root| root.importance(position, normal) > 0.0) {
            stack.push((0, [0.0, samples as f32]));
        }
        while let Some((index, [low, high])) = stack.pop() {
            let node = &self.nodes[index as usize];
            if node.is_leaf {
                out.push(Assigned { emitter: node.first, samples: count([low, high]), expected: high - low });
                continue;
            }
            let importance = [0, 1].map(|k| self.nodes[node.first as usize + k].importance(position, normal));
            let total = importance[0] + importance[1];
            if total <= 0.0 {
                continue;
            }
            let middle = low + (high - low) * (importance[0] / total);
            for (k, interval) in [(1, [middle, high]), (0, [low, middle])] {
                if count(interval) > 0 {
                    stack.push((node.first + k, interval));
                }
            }
        }
    }
}

fn leaf_of(emitter: &EmissiveTriangle, number: u32) -> EmitterNode {
    let [a, b, c] = emitter.corners;
    let front = emitter.front();
    let sides = if emitter.is_two_sided { 2.0 } else { 1.0 };
    EmitterNode {
        low: a.min(b).min(c),
        high: a.max(b).max(c),
        power: sides * 0.5 * front.length() * emitter.mean.element_sum(),
        axis: front.normalize_or(Vec3::Y),
        cos_spread: if emitter.is_two_sided { -1.0 } else { 1.0 },
        first: number,
        is_leaf: true,
    }
}

/// Builds the subtree of `leaves` at `nodes[at]`: a median split along the longest axis of the centres.
fn build(nodes: &mut Vec<EmitterNode>, at: usize, leaves: &mut [Leaf]) {
    if let [leaf] = leaves {
        nodes[at] = leaf.node;
        return;
    }
    let (low, high) = leaves.iter().fold((leaves[0].centre, leaves[0].centre), |(low, high), leaf| {
        (low.min(leaf.centre), high.max(leaf.centre))
    });
    let axis = (high - low).max_position();
    let middle = leaves.len() / 2;
    let by = |leaf: &Leaf| (leaf.centre[axis], leaf.node.first);
    leaves.select_nth_unstable_by(middle, |a, b| {
        let (a, b) = (by(a), by(b));
        a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
    });
    let first = nodes.len();
    nodes.extend([leaves[0].node; 2]);
    let (left, right) = leaves.split_at_mut(middle);
    build(nodes, first, left);
    build(nodes, first + 1, right);
    nodes[at] = nodes[first].union(&nodes[first + 1], first as u32);
}

impl EmitterNode {
    fn union(&self, other: &Self, first: u32) -> Self {
        let axis = (self.power * self.axis + other.power * other.axis).normalize_or(self.axis);
        let reach = |node: &Self| -> f32 {
            let (own, between) =
                (node.cos_spread.clamp(-1.0, 1.0).arc_cosine(), axis.angle_between(node.axis));
            own + between
        };
        let widest = reach(self).max(reach(other));
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            power: self.power + other.power,
            axis,
            cos_spread: if widest >= std::f32::consts::PI { -1.0 } else { widest.cosine() },
            first,
            is_leaf: false,
        }
    }

    /// Estimate of the irradiance at a receiver; 0 only if no part of the node shines on it.
    fn importance(&self, position: Vec3, normal: Vec3) -> f32 {
        // Farthest corner of the box along the normal: below the horizon if that corner is.
        let extreme = Vec3::select(normal.cmpge(Vec3::ZERO), self.high, self.low);
        if normal.dot(extreme - position) <= 0.0 {
            return 0.0;
        }
        let centre = 0.5 * (self.low + self.high);
        let radius_squared = 0.25 * (self.high - self.low).length_squared();
        let offset = centre - position;
        let distance_squared = offset.length_squared();
        let is_inside = distance_squared <= radius_squared;
        // Half angle of the bounding sphere as seen by the receiver.
        let half = if is_inside {
            std::f32::consts::PI
        } else {
            (radius_squared / distance_squared).sqrt().min(1.0).arc_sine()
        };
        let to_node = offset.normalize_or(normal);
        // Greatest cosines at the receiver and at the emitters.
        let at_receiver = (normal.angle_between(to_node) - half).clamp(0.0, 1.55).cosine();
        let turned = self.axis.angle_between(-to_node) - self.cos_spread.clamp(-1.0, 1.0).arc_cosine() - half;
        if self.cos_spread > -1.0 && turned >= std::f32::consts::FRAC_PI_2 + 1e-3 {
            return 0.0;
        }
        let at_emitter = if self.cos_spread <= -1.0 { 1.0 } else { turned.clamp(0.0, 1.55).cosine() };
        self.power * at_receiver * at_emitter / distance_squared.max(radius_squared).max(f32::MIN_POSITIVE)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Grid(Vec<EmissiveTriangle>);

    impl Emitters for Grid {
        fn emitter_count(&self) -> usize {
            self.0.len()
        }

        fn emitter(&self, number: u32) -> EmissiveTriangle {
            self.0[number as usize]
        }

        fn radiance(&self, number: u32, _weights: [f32; 3], _direction: Vec3) -> Vec3 {
            self.0[number as usize].mean
        }
    }

    /// Triangles on a ceiling, facing down, of different brightness.
    fn ceiling() -> Grid {
        let triangle = |k: usize| {
            let at = Vec3::new((k % 10) as f32, 3.0, (k / 10) as f32);
            EmissiveTriangle {
                corners: [at, at + 0.5 * Vec3::X, at + 0.5 * Vec3::Z],
                is_two_sided: k.is_multiple_of(3),
                material: 0,
                mean: Vec3::splat(1.0 + k as f32),
            }
        };
        Grid((0..50).map(triangle).collect())
    }

    #[test]
    fn samples_are_divided_without_bias_and_none_is_lost() {
        let grid = ceiling();
        let tree = EmitterTree::new(&grid, 0..grid.0.len() as u32);
        let mut stream = Stream::new(1, 1);
        let (mut out, mut sums) = (Vec::new(), vec![0.0; grid.emitter_count()]);
        let (rounds, samples) = (16_000, 16);
        for _ in 0..rounds {
            tree.assign(Vec3::new(3.0, 0.0, 2.0), Vec3::Y, samples, &mut stream, &mut out);
            assert_eq!(out.iter().map(|assigned| assigned.samples).sum::<u32>(), samples);
            for a in &out {
                assert!((a.samples as f32 - a.expected).abs() < 1.001, "{a:?}");
                sums[a.emitter as usize] += a.samples as f32 / a.expected / rounds as f32;
            }
        }
        // A sample's weight is 1 / expected: on average every triangle counts once.
        sums.iter().for_each(|sum| assert!((sum - 1.0).abs() < 0.15, "{sum}"));
        assert!((sums.iter().sum::<f32>() / 50.0 - 1.0).abs() < 0.01);
    }

    #[test]
    fn what_does_not_shine_on_the_receiver_gets_no_sample() {
        let mut grid = ceiling();
        let mut stream = Stream::new(1, 1);
        let mut out = Vec::new();
        let tree = EmitterTree::new(&grid, 0..grid.0.len() as u32);
        // Below the receiver's horizon.
        tree.assign(Vec3::new(3.0, 0.0, 2.0), Vec3::NEG_Y, 16, &mut stream, &mut out);
        assert!(out.is_empty());
        // Behind: only two-sided triangles shine upwards.
        tree.assign(Vec3::new(3.0, 9.0, 2.0), Vec3::NEG_Y, 64, &mut stream, &mut out);
        assert!(!out.is_empty() && out.iter().all(|a| grid.0[a.emitter as usize].is_two_sided), "{out:?}");
        grid.0.clear();
        EmitterTree::new(&grid, 0..grid.0.len() as u32).assign(
            Vec3::ZERO,
            Vec3::Y,
            16,
            &mut stream,
            &mut out,
        );
        assert!(out.is_empty());
    }
}
