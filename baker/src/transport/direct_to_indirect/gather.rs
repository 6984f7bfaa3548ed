//! Hemispherical gather: a receiver's row of irradiance from all senders (Eq. 16), less what its parents predict (Eq. 17).

use super::accumulator::SparseAccumulator;
use super::directions::Directions;
use super::gather_batch::GatherBatch;
use super::gather_context::{GatherContext, GatherCost, PREDICTED};
use super::neighbourhood::{Difference, Neighbourhood, Row};
use super::sparsify::{PooledNoise, sparsify, sparsify_pooled};
use crate::geometry::Surfaces;
use rebounce_shared::link::{Link, Sent};

/// ε of a receiver's value as its children subtract it, over that of its links: a value's small parts are
/// carried over like a link's, which keeps values short and changes nothing but the place that they come from.
const VALUE_EPSILON: f32 = 0.5;

/// Rays that are cast and kept at once, for as many receivers as they are enough for: so many that those that go alike
/// are some, and so few that they stay near.
const TOGETHER: usize = 1 << 12;

/// Receivers whose rays are cast at once.
pub fn receivers_together(directions: &Directions) -> usize {
    (TOGETHER / directions.len().max(1)).max(1)
}

/// Some receivers of a level to gather for.
pub struct Gather<'a> {
    /// The receivers.
    pub receivers: &'a [usize],
    /// Their level.
    pub level: usize,
    /// The directions of their rays.
    pub directions: &'a Directions,
    /// The [values](Gathered::value) of all coarser levels.
    pub values: &'a [Vec<Link>],
}

/// What one gather finds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gathered {
    /// The receiver's links, senders ascending: differences to what coarser receivers say.
    pub links: Vec<Link>,
    /// The whole value that its links and its ancestors' say, where children or later bounces read it: on all levels but
    /// the finest, and of points that later bounces travel through.
    pub value: Vec<Link>,
    /// The cost.
    pub cost: GatherCost,
}

impl Gathered {
    /// Whether it can be of a scene with so many senders, whoever says it: indices are under that and ascend, numbers
    /// are finite.
    pub fn fits(&self, senders: usize) -> bool {
        let row = |links: &[Link]| {
            links.windows(2).all(|pair| pair[0].sender() < pair[1].sender())
                && links.last().is_none_or(|last| last.sender() < senders)
        };
        row(&self.links)
            && row(&self.value)
            && self.cost.rays <= u32::MAX as u64
            && self.cost.seen.is_finite()
            && self.cost.lost.is_finite()
    }
}

/// A thread's working memory, reused from receiver to receiver.
pub struct Scratch {
    /// What rays find, and what coarser receivers say: [`GATHERED`], [`PREDICTED`].
    senders: SparseAccumulator<2>,
    found: GatherBatch,
    /// A receiver's own differences and its neighbourhood's.
    pooled: SparseAccumulator<4>,
    neighbourhood: Neighbourhood,
}

impl Scratch {
    /// Working memory for this many senders.
    pub fn new(senders: usize) -> Self {
        Self {
            senders: SparseAccumulator::new(senders),
            found: GatherBatch::default(),
            pooled: SparseAccumulator::new(senders),
            neighbourhood: Neighbourhood::default(),
        }
    }
}

impl<S: Surfaces + ?Sized> GatherContext<'_, S> {
    /// The links of some receivers of a level, and more: tells `cast` the rays of each, and `done` what they make, in turn. Fastest
    /// for neighbours.
    ///
    /// # Errors
    /// What `cast` returns.
    pub fn links<E>(
        &self,
        gather: &Gather,
        scratch: &mut Scratch,
        mut cast: impl FnMut(u64) -> Result<(), E>,
        mut done: impl FnMut(usize, Gathered),
    ) -> Result<(), E> {
        let &Gather { receivers, level, directions, values } = gather;
        if self.settings.is_pooled(level) {
            return self.pooled_links(gather, scratch, cast, done);
        }
        // The variance of a mean of rays that either hit a sender or do not, per unit seen.
        let noise = self.settings.significance.powi(2) / directions.len() as f32;
        let epsilon = self.settings.epsilon_on(level);
        let Scratch { senders, found, .. } = scratch;
        for group in receivers.chunks(receivers_together(directions)) {
            found.cast(self, group, directions);
            for (k, &receiver) in group.iter().enumerate() {
                let cost = GatherCost { rays: directions.len() as u64, ..found.add(k, senders) };
                let mut gathered = Gathered { cost, ..Gathered::default() };
                self.predict(receiver, values, senders);
                gathered.links = sparsify(senders, |[found, said]| (found, said), epsilon, noise);
                if self.is_read(receiver, level) {
                    gathered.value = self.value_with(&gathered.links, level, senders);
                }
                senders.clear();
                cast(cost.rays)?;
                done(receiver, gathered);
            }
        }
        Ok(())
    }

    /// As [`Self::links`], of receivers that share what their rays find.
    fn pooled_links<E>(
        &self,
        gather: &Gather,
        scratch: &mut Scratch,
        mut cast: impl FnMut(u64) -> Result<(), E>,
        mut done: impl FnMut(usize, Gathered),
    ) -> Result<(), E> {
        let &Gather { receivers, level, directions, values } = gather;
        let (mut rows, mut costs) = (Vec::new(), Vec::new());
        let Scratch { senders, found, pooled, neighbourhood } = scratch;
        for group in receivers.chunks(receivers_together(directions)) {
            found.cast(self, group, directions);
            for (k, &receiver) in group.iter().enumerate() {
                costs.push(GatherCost { rays: directions.len() as u64, ..found.add(k, senders) });
                self.predict(receiver, values, senders);
                let mut differences = Vec::new();
                senders.each(|sender, [found, said]| {
                    let magnitude = found.abs().max(said.abs());
                    differences.push(Difference { sender, amount: found - said, magnitude });
                });
                senders.clear();
                rows.push(Row { differences, distance: found.distance(k) });
                cast(directions.len() as u64)?;
            }
        }
        let support = self.points.levels[level].support_radius;
        let epsilon = self.settings.epsilon_on(level);
        let rays = directions.len() as f32;
        for (k, &receiver) in receivers.iter().enumerate() {
            neighbourhood.gather(self.points, receivers, k, support);
            for difference in &rows[k].differences {
                pooled.add_each(
                    difference.sender as usize,
                    [difference.amount, difference.magnitude, 0.0, 0.0],
                );
            }
            neighbourhood.each(self.points, self.sender_blocks, &rows, |sender, amount, magnitude| {
                pooled.add_each(sender as usize, [0.0, 0.0, amount, magnitude]);
            });
            let strictness = rows[k].strictness(support, self.settings.levels - 1 - level);
            let noise = (self.settings.significance * strictness).powi(2);
            let (sum, variance) = neighbourhood.sum(&rows);
            let noises = PooledNoise { pooled: noise / rays, own: rays.recip(), sum: noise * variance };
            let links = sparsify_pooled(pooled, sum, epsilon, noises);
            pooled.clear();
            let mut gathered = Gathered { cost: costs[k], links, ..Gathered::default() };
            if self.is_read(receiver, level) {
                self.predict(receiver, values, senders);
                gathered.value = self.value_with(&gathered.links, level, senders);
                senders.clear();
            }
            done(receiver, gathered);
        }
        Ok(())
    }

    /// Whether anything reads a receiver's whole value.
    fn is_read(&self, receiver: usize, level: usize) -> bool {
        level + 1 < self.settings.levels || receiver < self.coarse_count
    }

    /// What is left of a receiver that is not refined: the value that its parents' say.
    pub fn inherit(
        &self,
        receiver: usize,
        level: usize,
        values: &[Vec<Link>],
        scratch: &mut Scratch,
    ) -> Gathered {
        if !self.is_read(receiver, level) {
            return Gathered::default();
        }
        self.predict(receiver, values, &mut scratch.senders);
        let value = self.value(level, &scratch.senders);
        scratch.senders.clear();
        Gathered { value, ..Gathered::default() }
    }

    /// A receiver's parents and their shares, which sum to 1.
    fn parents(&self, receiver: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        let row = self.relations.push().row(receiver);
        let total: f32 = row.iter().map(|e| e.weight()).sum();
        row.iter().map(move |e| (e.point(), e.weight() / total))
    }

    /// A receiver's value as its children will subtract it.
    fn value(&self, level: usize, sums: &SparseAccumulator<2>) -> Vec<Link> {
        sparsify(sums, |[_, said]| (said, 0.0), VALUE_EPSILON * self.settings.epsilon_on(level), 0.0)
    }

    /// The same of a receiver with links of its own: the sum of these and the parents' values in `sums`.
    fn value_with(&self, links: &[Link], level: usize, sums: &mut SparseAccumulator<2>) -> Vec<Link> {
        for link in links {
            sums.add(PREDICTED, link.sender(), link.amount());
        }
        self.value(level, sums)
    }

    /// Eq. 17: what the parents' values say at this receiver, as the push will interpolate it.
    fn predict(&self, receiver: usize, values: &[Vec<Link>], sums: &mut SparseAccumulator<2>) {
        for (parent, share) in self.parents(receiver) {
            for link in &values[parent] {
                sums.add(PREDICTED, link.sender(), share * link.amount());
            }
        }
    }
}
