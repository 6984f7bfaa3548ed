//! Hemispherical gather: a receiver's row of irradiance from all senders (Eq. 16), minus the
//! prediction from the parents' values (Eq. 17).

use super::accumulator::SparseAccumulator;
use super::directions::Directions;
use super::gather_batch::GatherBatch;
use super::gather_context::{GatherContext, GatherCost, PREDICTED};
use super::neighbourhood::{Difference, Neighbourhood, Row};
use super::pairwise;
use super::pairwise::handed::HandedLink;
use super::pairwise::inspect::PairScratch;
use super::sparsify::{PooledNoise, sparsify, sparsify_pooled};
use crate::geometry::Surfaces;
use rebounce_shared::link::{Link, Sent};

/// Ratio of the ε for a receiver's value, as subtracted by the receiver's children, to the ε for
/// links. Small entries of a value are carried over as in a row of links: values stay short, and
/// only the sender of the light changes.
const VALUE_EPSILON: f32 = 0.5;

/// Rays per gather batch, rounded down to whole receivers: enough for coherent packets, and few
/// enough for the cache.
const TOGETHER: usize = 1 << 12;

/// Receivers per gather batch.
pub fn receivers_together(directions: &Directions) -> usize {
    (TOGETHER / directions.len().max(1)).max(1)
}

/// Receivers of a level to gather for.
pub struct Gather<'a> {
    /// Indices of the receivers.
    pub receivers: &'a [usize],
    /// Level of the receivers.
    pub level: usize,
    /// Ray directions of each receiver.
    pub directions: &'a Directions,
    /// The [values](Gathered::value) of all coarser levels.
    pub values: &'a [Vec<Link>],
}

/// Result of a gather for a receiver.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gathered {
    /// The receiver's links, senders ascending: differences to the values of the parents.
    pub links: Vec<Link>,
    /// The receiver's total irradiance per sender: its own links plus the interpolated values of
    /// its parents. Filled only for receivers whose value is read: on all levels but the finest,
    /// and at points of later bounces.
    pub value: Vec<Link>,
    /// Links that the receiver's children take over; empty without [pairwise links](super::pairwise).
    pub handed: Vec<HandedLink>,
    /// Cost of the gather.
    pub cost: GatherCost,
}

impl Gathered {
    /// Whether data of unknown origin is valid in a scene with `senders` senders: sender indices
    /// are in range and ascend, the number of rays is below 2³², and the other numbers are finite.
    pub fn fits(&self, senders: usize) -> bool {
        let row = |links: &[Link]| {
            links.windows(2).all(|pair| pair[0].sender() < pair[1].sender())
                && links.last().is_none_or(|last| last.sender() < senders)
        };
        row(&self.links)
            && row(&self.value)
            && pairwise::handed::fits(&self.handed, senders)
            && self.cost.rays <= u32::MAX as u64
            && self.cost.seen.is_finite()
            && self.cost.lost.is_finite()
    }
}

/// Working memory of a thread, reused between receivers.
pub struct Scratch {
    /// Gathered and predicted irradiance by sender: [`GATHERED`](super::gather_context::GATHERED),
    /// [`PREDICTED`].
    pub(super) senders: SparseAccumulator<2>,
    found: GatherBatch,
    /// A receiver's own differences and the mean differences of the neighbourhood.
    pooled: SparseAccumulator<4>,
    neighbourhood: Neighbourhood,
    pub(super) pairs: PairScratch,
}

impl Scratch {
    /// Allocates working memory for `senders` senders.
    pub fn new(senders: usize) -> Self {
        Self {
            senders: SparseAccumulator::new(senders),
            found: GatherBatch::default(),
            pooled: SparseAccumulator::new(senders),
            neighbourhood: Neighbourhood::default(),
            pairs: PairScratch::default(),
        }
    }
}

impl<S: Surfaces + ?Sized> GatherContext<'_, S> {
    /// Gathers for the receivers of a level. Calls `done` with each receiver and its result. Fastest for
    /// neighbouring receivers.
    pub fn links(&self, gather: &Gather, scratch: &mut Scratch, mut done: impl FnMut(usize, Gathered)) {
        let &Gather { receivers, level, directions, values } = gather;
        if self.settings.is_pooled(level) {
            return self.pooled_links(gather, scratch, done);
        }
        // Variance of a mean of rays with a binary outcome (hit or miss of a sender), per unit of
        // gathered irradiance, times the squared significance.
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
                done(receiver, gathered);
            }
        }
    }

    /// [`Self::links`] for a level whose receivers share gathered differences.
    fn pooled_links(&self, gather: &Gather, scratch: &mut Scratch, mut done: impl FnMut(usize, Gathered)) {
        let &Gather { receivers, level, directions, values } = gather;
        let (mut rows, mut costs) = (Vec::new(), Vec::new());
        let Scratch { senders, found, pooled, neighbourhood, .. } = scratch;
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
    }

    /// Whether a receiver's value is read: by children or by later bounces.
    pub(super) fn is_read(&self, receiver: usize, level: usize) -> bool {
        level + 1 < self.settings.levels || receiver < self.coarse_count
    }

    /// Returns the result of a receiver that is not refined: no links, and the value interpolated
    /// from its parents.
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
    pub(super) fn parents(&self, receiver: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        let row = self.relations.push().row(receiver);
        let total: f32 = row.iter().map(|e| e.weight()).sum();
        row.iter().map(move |e| (e.point(), e.weight() / total))
    }

    /// Sparsifies the predicted sums into a receiver's value, as its children subtract it.
    fn value(&self, level: usize, sums: &SparseAccumulator<2>) -> Vec<Link> {
        sparsify(sums, |[_, said]| (said, 0.0), VALUE_EPSILON * self.settings.epsilon_on(level), 0.0)
    }

    /// Sparsifies the value of a receiver with its own links: the links plus the parents' values in
    /// `sums`.
    pub(super) fn value_with(
        &self,
        links: &[Link],
        level: usize,
        sums: &mut SparseAccumulator<2>,
    ) -> Vec<Link> {
        for link in links {
            sums.add(PREDICTED, link.sender(), link.amount());
        }
        self.value(level, sums)
    }

    /// Eq. 17: adds the parents' values at this receiver, interpolated as in the push.
    pub(super) fn predict(&self, receiver: usize, values: &[Vec<Link>], sums: &mut SparseAccumulator<2>) {
        for (parent, share) in self.parents(receiver) {
            for link in &values[parent] {
                sums.add(PREDICTED, link.sender(), share * link.amount());
            }
        }
    }
}
