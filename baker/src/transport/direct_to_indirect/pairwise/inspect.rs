//! Links of a receiver: the initial gather or the links handed down by its parents, inspected one at a time and refined.
//!
//! A receiver without parents gathers its hemisphere for links from the coarsest senders. Any other begins with what its
//! parents have handed down: for each sender, the share φ of the transport and the irradiance U that interpolation of the
//! parents gives. Its link holds the difference φ K − U (Eq. 17 of the 2008 paper). What the [oracle](super::oracle) refines
//! at the sender is replaced by links from the sender's children, and these are inspected in turn; what it refines at the
//! receiver is handed down.

use super::super::accumulator::SparseAccumulator;
use super::super::directions::Directions;
use super::super::gather_batch::GatherBatch;
use super::super::gather_context::{GATHERED, GatherContext, GatherCost, PREDICTED};
use super::Pairwise;
use super::coefficient::{Coefficient, Viewpoint, coefficient, unoccluded};
use super::oracle::{Inspection, Oracle, RefinedEnd};
use super::quadrature::PLACES;
use crate::geometry::Surfaces;
use bytemuck::{Pod, Zeroable};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

/// A link that is refined at its receiver, as the receiver's children take it over.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct HandedLink {
    /// Index of the sender.
    pub sender: u32,
    /// Share of the transport between receiver and sender that the link stands for, 0 to 1.
    pub share: f32,
    /// Irradiance of the receiver per unit irradiance at the sender.
    pub amount: f32,
}

/// A link to inspect.
#[derive(Clone, Copy, Debug)]
struct OpenLink {
    share: f32,
    /// Irradiance that the parents' links give already.
    predicted: f32,
    /// Irradiance found by the initial gather; `None` where the kernel says it.
    gathered: Option<f32>,
}

/// Least share of a link that is refined on.
const LEAST_SHARE: f32 = 1e-4;

/// Working memory of a thread.
#[derive(Default)]
pub struct PairScratch {
    found: GatherBatch,
    /// Links to inspect, by sender: senders come before their children, and shares of a child add up before it is
    /// inspected.
    open: BTreeMap<u32, OpenLink>,
}

impl PairScratch {
    /// Adds a link to inspect.
    fn open(&mut self, sender: u32, link: OpenLink) {
        match self.open.entry(sender) {
            Entry::Vacant(place) => drop(place.insert(link)),
            Entry::Occupied(mut known) => {
                let known = known.get_mut();
                known.share += link.share;
                known.predicted += link.predicted;
            }
        }
    }
}

/// Links of a receiver before sparsification, beside the sums by sender.
#[derive(Clone, Debug, Default)]
pub struct Inspected {
    /// Links that the receiver's children take over, senders ascending.
    pub handed: Vec<HandedLink>,
    /// Rays, and light found by the initial gather.
    pub cost: GatherCost,
}

/// Ends of a receiver's links.
struct Ends {
    receiver: Viewpoint,
    /// Children of the receiver; none on the finest level.
    children: Vec<Viewpoint>,
    /// Number of senders.
    senders: usize,
}

/// A receiver whose links are inspected.
pub struct PairReceiver<'a, S: Surfaces + ?Sized> {
    /// Surfaces, points and settings.
    pub context: &'a GatherContext<'a, S>,
    /// Senders and children.
    pub pairwise: &'a Pairwise,
    /// Index of the receiver.
    pub receiver: usize,
    /// Its level.
    pub level: usize,
}

impl<S: Surfaces + ?Sized> PairReceiver<'_, S> {
    /// Inspects the links of a receiver without parents: those from all functions of the coarsest level, and from others
    /// that rays in `directions` find.
    pub fn initial(
        &self,
        directions: &Directions,
        sums: &mut SparseAccumulator<2>,
        scratch: &mut PairScratch,
    ) -> Inspected {
        scratch.found.cast(self.context, &[self.receiver], directions);
        let cost = scratch.found.add(0, sums);
        let mut initial = vec![0.0; self.pairwise.root_count];
        sums.each(|sender, [amount, _]| match initial.get_mut(sender as usize) {
            Some(initial) => *initial = amount,
            None => scratch.open(sender, OpenLink { share: 1.0, predicted: 0.0, gathered: Some(amount) }),
        });
        sums.clear();
        // Pairs that no ray has found are inspected too: the receiver's children may see what it does not.
        for (sender, amount) in (0..).zip(initial) {
            scratch.open(sender, OpenLink { share: 1.0, predicted: 0.0, gathered: Some(amount) });
        }
        let mut out = Inspected { cost, ..Inspected::default() };
        out.cost.rays = directions.len() as u64;
        self.refine(sums, scratch, &mut out);
        out
    }

    /// Inspects the links that parents hand down; `parents` are their links with the parent's share in the receiver.
    pub fn handed_down<'h>(
        &self,
        parents: impl Iterator<Item = (&'h [HandedLink], f32)>,
        sums: &mut SparseAccumulator<2>,
        scratch: &mut PairScratch,
    ) -> Inspected {
        for (links, share) in parents {
            for link in links {
                let predicted = share * link.amount;
                scratch.open(link.sender, OpenLink { share: share * link.share, predicted, gathered: None });
            }
        }
        let mut out = Inspected::default();
        self.refine(sums, scratch, &mut out);
        out
    }

    /// Inspects the open links and what they are refined to.
    fn refine(&self, sums: &mut SparseAccumulator<2>, scratch: &mut PairScratch, out: &mut Inspected) {
        let settings = self.context.settings;
        let oracle = Oracle {
            epsilon: settings.epsilon_on(self.level),
            finer_epsilon: settings.epsilon_on(self.level + 1),
        };
        let point = &self.context.points.points[self.receiver];
        let ends = Ends {
            receiver: Viewpoint::of(self.context.surfaces, point),
            children: self.children(),
            senders: self.pairwise.quadrature.count(),
        };
        while let Some((sender, link)) = scratch.open.pop_first() {
            let sender = sender as usize;
            let (found, decided, amount) = self.inspect(sender, &link, &ends, &oracle, &mut out.cost);
            sums.add(PREDICTED, sender, link.predicted);
            if decided == Some(RefinedEnd::Sender) {
                if found.kept > 0.0 {
                    sums.add(GATHERED, sender, link.share * found.kept);
                }
                for &(child, under) in self.pairwise.children.of(sender) {
                    if (child as usize) < ends.senders {
                        let share = link.share * under;
                        scratch.open(child, OpenLink { share, predicted: 0.0, gathered: None });
                    }
                }
                continue;
            }
            sums.add(GATHERED, sender, amount);
            if decided == Some(RefinedEnd::Receiver) {
                out.handed.push(HandedLink { sender: sender as u32, share: link.share, amount });
            }
        }
    }

    /// Coefficient of a link, the end to refine, and the link's amount.
    fn inspect(
        &self,
        sender: usize,
        link: &OpenLink,
        ends: &Ends,
        oracle: &Oracle,
        cost: &mut GatherCost,
    ) -> (Coefficient, Option<RefinedEnd>, f32) {
        let &OpenLink { share, predicted, gathered } = link;
        let (surfaces, quadrature) = (self.context.surfaces, &self.pairwise.quadrature);
        let found = coefficient(surfaces, quadrature, &ends.receiver, sender, self.context.duals[sender]);
        let (over_receiver, strongest, rays) = self.over_children(sender, &found, &ends.children);
        cost.rays += found.rays as u64 + rays;
        let amount = gathered.unwrap_or(share * found.amount);
        let mut children = self.pairwise.children.of(sender).iter();
        let is_refinable = share > LEAST_SHARE && children.any(|child| (child.0 as usize) < ends.senders);
        let decided = oracle.decide(&Inspection {
            over_sender: if is_refinable { share * found.deviation } else { 0.0 },
            over_receiver: share * over_receiver,
            magnitude: amount.abs().max(predicted.abs()).max(share * strongest),
        });
        (found, decided, amount)
    }

    /// At most [`PLACES`] of the receiver's children, spread over all of them.
    fn children(&self) -> Vec<Viewpoint> {
        let all = self.pairwise.children.of(self.receiver);
        let count = all.len().min(PLACES);
        let place = |k: usize| all[k * all.len() / count].0 as usize;
        (0..count)
            .map(|k| Viewpoint::of(self.context.surfaces, &self.context.points.points[place(k)]))
            .collect()
    }

    /// Deviation of the kernel over the receiver's children, its greatest amount there, and the number of rays. The kernel
    /// without visibility is evaluated at every child; one ray from each, to a place of its own, says which share of the
    /// children sees the sender.
    fn over_children(&self, sender: usize, found: &Coefficient, children: &[Viewpoint]) -> (f32, f32, u64) {
        let (quadrature, dual) = (&self.pairwise.quadrature, self.context.duals[sender]);
        if children.is_empty() || quadrature.area(sender) <= 0.0 {
            return (0.0, 0.0, 0);
        }
        let (mut squares, mut all, mut seen, mut strongest, mut rays) = (0.0, 0.0, 0.0, 0f32, 0);
        let at_receiver = if found.visible > 0.0 { found.amount / found.visible } else { 0.0 };
        for (k, child) in children.iter().enumerate() {
            let open = unoccluded(quadrature, child, sender, dual);
            squares += (open - at_receiver).powi(2);
            all += open;
            let place = &quadrature.places(sender)[k % PLACES];
            let is_above = (place.position - child.origin).dot(child.geometric_normal) > 0.0;
            if open > 0.0 && is_above {
                rays += 1;
                let through = self.context.surfaces.transmittance(child.origin, place.position);
                let visible = through.element_sum() / 3.0;
                seen += open * visible;
                strongest = strongest.max(open * visible);
            }
        }
        let count = children.len() as f32;
        let mean = all / count;
        // The receiver's own rays count as those of a child.
        let visible = (seen + found.amount) / (all + at_receiver).max(f32::MIN_POSITIVE);
        let visible = visible.clamp(0.0, 1.0);
        let hidden = mean * mean * visible * (1.0 - visible);
        ((visible * visible * squares / count + hidden).sqrt(), strongest, rays)
    }
}

/// Whether links from elsewhere are valid: senders ascend and are in range, numbers are finite.
pub fn fits(links: &[HandedLink], senders: usize) -> bool {
    links.windows(2).all(|pair| pair[0].sender < pair[1].sender)
        && links.last().is_none_or(|last| (last.sender as usize) < senders)
        && links.iter().all(|link| link.share.is_finite() && link.amount.is_finite())
}
