//! Rows of [pairwise links](super::pairwise): a receiver's inspected links, sparsified as gathered rows are.

use super::directions::Directions;
use super::gather::{Gathered, Scratch};
use super::gather_context::{GatherContext, GatherCost};
use super::pairwise::Pairwise;
use super::pairwise::handed::HandedLink;
use super::pairwise::inspect::{Inspected, PairReceiver};
use super::sparsify::sparsify;
use crate::geometry::Surfaces;
use rebounce_shared::link::Link;

/// Receivers of a level whose links are inspected.
pub struct PairGather<'a> {
    /// Indices of the receivers.
    pub receivers: &'a [usize],
    /// Level of the receivers.
    pub level: usize,
    /// Directions of the initial gather.
    pub directions: &'a Directions,
    /// The [values](Gathered::value) of all coarser levels.
    pub values: &'a [Vec<Link>],
    /// Links that receivers of coarser levels hand to their children.
    pub handed: &'a [Vec<HandedLink>],
    /// Row sums of receivers of coarser levels.
    pub row_sums: &'a [f32],
    /// Senders and children.
    pub pairwise: &'a Pairwise,
}

impl<S: Surfaces + ?Sized> GatherContext<'_, S> {
    /// Inspects the links of a level's receivers. Calls `done` with each receiver and its result.
    pub fn pair_links(
        &self,
        gather: &PairGather,
        scratch: &mut Scratch,
        mut done: impl FnMut(usize, Gathered),
    ) {
        let &PairGather { receivers, level, directions, values, handed, row_sums, pairwise } = gather;
        let epsilon = self.settings.epsilon_on(level);
        let Scratch { senders, pairs, .. } = scratch;
        for &receiver in receivers {
            let pair = PairReceiver { context: self, pairwise, receiver, level };
            let is_initial = self.relations.push().row(receiver).is_empty();
            let Inspected { handed, mut cost } = if is_initial {
                pair.initial(directions, senders, pairs)
            } else {
                let parents = self.parents(receiver);
                pair.handed_down(parents.map(|(k, share)| (&handed[k][..], share)), senders, pairs)
            };
            if !is_initial {
                // What the row would say without sparsification, in place of what rays have seen.
                cost = GatherCost {
                    seen: self.parents(receiver).map(|(k, share)| (share * row_sums[k]) as f64).sum(),
                    ..cost
                };
                senders.each(|_, [found, said]| cost.seen += (found - said) as f64);
            }
            let links = sparsify(senders, |[found, said]| (found, said), epsilon, 0.0);
            senders.clear();
            let mut gathered = Gathered { links, handed, cost, ..Gathered::default() };
            if receiver < self.coarse_count {
                self.predict(receiver, values, senders);
                gathered.value = self.value_with(&gathered.links, level, senders);
                senders.clear();
            }
            done(receiver, gathered);
        }
    }
}
