//! Links of a receiver: the initial gather or the links handed down by its parents, inspected one at a time and refined.
//!
//! A receiver without parents gathers its hemisphere for links from the coarsest senders. Any other begins with what its
//! parents have handed down: for each sender, the share φ of the transport and the irradiance U that interpolation of the
//! parents gives. Its link holds the difference φ K − U (Eq. 17 of the 2008 paper). What the [oracle](super::oracle) refines
//! at the sender is replaced by links from the sender's children, and these are inspected in turn; what it refines at the
//! receiver is handed down.

use super::super::accumulator::SparseAccumulator;
use super::super::directions::Directions;
use super::super::gather_context::{GATHERED, GatherContext, GatherCost, PREDICTED};
use super::Pairwise;
use super::coefficient::{Coefficient, Viewpoint, coefficient, unoccluded};
use super::handed::HandedLink;
use super::hits::HemisphereHits;
use super::oracle::{Inspection, Oracle, RefinedEnd};
use super::quadrature::PLACES;
use crate::geometry::Surfaces;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, HashMap};

/// A link to inspect.
#[derive(Clone, Copy, Debug, Default)]
struct OpenLink {
    share: f32,
    /// Irradiance that the parents' links give already.
    predicted: f32,
    /// Irradiance known beforehand: found by the initial gather, or a part of a refined link.
    known: Option<f32>,
    /// Whether it is part of a link that varies over the receiver's children: the part may be too weak to tell by itself.
    varies: bool,
}

impl OpenLink {
    /// The part of a refined link that a child of its sender takes over.
    fn part(share: f32, amount: f32, varies: bool) -> Self {
        Self { share, known: Some(amount), varies, ..Self::default() }
    }
}

/// Least magnitude of a link that is handed down, as a share of the oracle's threshold.
const LEAST_HANDED: f32 = 1.0 / 64.0;
/// Least share of a link that is refined on.
const LEAST_SHARE: f32 = 1e-4;

/// Working memory of a thread.
#[derive(Default)]
pub struct PairScratch {
    /// Links that parents hand down, by sender: share, amount, amount without visibility, number of refined ones.
    handed: Option<SparseAccumulator<4>>,
    hits: HemisphereHits,
    /// Whether the receiver's hemisphere is cast.
    has_hits: bool,
    /// Coefficients of the receiver found so far, by sender.
    known: HashMap<u32, Coefficient>,
    /// Links to inspect, by sender: senders come before their children, and shares of a child add up before it is
    /// inspected.
    open: BTreeMap<u32, OpenLink>,
}

/// Range of the factor on a link's share by which its known amount corrects its coefficient.
const CORRECTED: [f32; 2] = [0.75, 1.33];
/// Least deviation of light over a sender with children, as a share of what arrives: the light of a coarse sender is a mean
/// of its children's (pull), which is off where a small patch of it is lit.
const UNKNOWN_LIGHT: f32 = 0.5;

/// Adds to a sum. What is zero stays untouched: sparsification carries rounding errors on to the next sender of a row, which
/// must not be one behind a wall.
fn add(sums: &mut SparseAccumulator<2>, which: usize, sender: usize, amount: f32) {
    if amount != 0.0 {
        sums.add(which, sender, amount);
    }
}

/// Quotient, and 1 where the divisor is 0.
fn ratio(a: f32, b: f32) -> f32 {
    if b > 0.0 { a / b } else { 1.0 }
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
                known.varies |= link.varies;
                known.known = known.known.zip(link.known).map(|(a, b)| a + b);
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
        let cost = scratch.hits.cast(self.context, self.receiver, directions, f32::INFINITY);
        // Pairs that no ray has found are inspected too: the receiver's children may see what it does not.
        for sender in 0..self.pairwise.root_count as u32 {
            scratch.open(sender, OpenLink::part(1.0, 0.0, false));
        }
        let PairScratch { hits, open, .. } = scratch;
        hits.initial(|sender, amount| {
            open.insert(sender, OpenLink::part(1.0, amount, false));
        });
        scratch.has_hits = true;
        let mut out = Inspected { cost, ..Inspected::default() };
        self.refine(&self.ends(), &self.oracle(), sums, scratch, &mut out);
        out
    }

    /// Inspects the links that parents hand down; `parents` are their links with the parent's share in the receiver.
    pub fn handed_down<'h>(
        &self,
        parents: impl Iterator<Item = (&'h [HandedLink], f32)>,
        sums: &mut SparseAccumulator<2>,
        scratch: &mut PairScratch,
    ) -> Inspected {
        scratch.has_hits = false;
        let handed =
            scratch.handed.get_or_insert_with(|| SparseAccumulator::new(self.pairwise.quadrature.count()));
        for (links, share) in parents {
            for link in links {
                let sums =
                    [share * link.share, share * link.amount, share * link.open, link.is_refined as f32];
                handed.add_each(link.sender as usize, sums);
            }
        }
        let (open, oracle, ends) = (&mut scratch.open, self.oracle(), self.ends());
        let mut out = Inspected::default();
        handed.each(|sender, [share, predicted, open_before, refined]| {
            let at = sender as usize;
            add(sums, PREDICTED, at, predicted);
            if refined == 0.0 {
                let without = share * unoccluded(&self.pairwise.quadrature, &ends.receiver, at);
                let amount = predicted * ratio(without, open_before);
                if (amount - predicted).abs() <= oracle.epsilon {
                    add(sums, GATHERED, at, amount);
                    self.hand(HandedLink { sender, share, amount, open: without, is_refined: 0 }, &mut out);
                    return;
                }
            }
            open.insert(sender, OpenLink { share, predicted, ..OpenLink::default() });
        });
        handed.clear();
        self.refine(&ends, &oracle, sums, scratch, &mut out);
        out
    }

    /// Adds a link to those that the children take over, if there are any and it is not too weak.
    fn hand(&self, link: HandedLink, out: &mut Inspected) {
        let settings = self.context.settings;
        let least = LEAST_HANDED * settings.epsilon_on(self.level);
        if self.level + 1 < settings.levels && link.amount.max(link.open) > least {
            out.handed.push(link);
        }
    }

    fn oracle(&self) -> Oracle {
        let settings = self.context.settings;
        Oracle {
            epsilon: settings.epsilon_on(self.level),
            finer_epsilon: settings.epsilon_on(self.level + 1),
        }
    }

    fn ends(&self) -> Ends {
        let point = &self.context.points.points[self.receiver];
        Ends { receiver: Viewpoint::of(self.context.surfaces, point), children: self.children() }
    }

    /// Inspects the open links and what they are refined to.
    fn refine(
        &self,
        ends: &Ends,
        oracle: &Oracle,
        sums: &mut SparseAccumulator<2>,
        scratch: &mut PairScratch,
        out: &mut Inspected,
    ) {
        scratch.known.clear();
        while let Some((sender, link)) = scratch.open.pop_first() {
            let at = sender as usize;
            let found = self.coefficient(at, &ends.receiver, scratch, &mut out.cost);
            let amount = link.known.unwrap_or(link.share * found.amount);
            let share =
                link.share * ratio(amount, link.share * found.amount).clamp(CORRECTED[0], CORRECTED[1]);
            let inspection = self.inspection(at, &link, amount, &found, ends, &mut out.cost);
            let decided = oracle.decide(&inspection);
            let varies = link.varies || inspection.over_receiver > oracle.finer_epsilon;
            if decided == Some(RefinedEnd::Sender) {
                let children = self.pairwise.sender_children.of(at);
                let of_children: Vec<f32> = children
                    .iter()
                    .map(|&(child, under)| {
                        let found = self.coefficient(child as usize, &ends.receiver, scratch, &mut out.cost);
                        link.share * under * found.amount
                    })
                    .collect();
                let sum: f32 = of_children.iter().sum();
                // A link keeps its sum; it stays where no child's rays meet what its own have.
                if sum > 0.0 {
                    let kept = link.share * found.kept;
                    add(sums, GATHERED, at, kept);
                    let scale = (amount - kept).max(0.0) / sum;
                    for (&(child, under), part) in children.iter().zip(of_children) {
                        scratch.open(child, OpenLink::part(link.share * under, scale * part, varies));
                    }
                    continue;
                }
            }
            add(sums, GATHERED, at, amount);
            let is_refined = (link.varies || decided == Some(RefinedEnd::Receiver)) as u32;
            let open = share * found.open;
            self.hand(HandedLink { sender, share, amount, open, is_refined }, out);
        }
        // A sender may have a smooth link, and one that is part of a coarser sender's.
        out.handed.sort_by_key(|link| link.sender);
        out.handed.dedup_by(|link, kept| {
            let is_same = link.sender == kept.sender;
            if is_same {
                kept.share += link.share;
                kept.amount += link.amount;
                kept.open += link.open;
                kept.is_refined |= link.is_refined;
            }
            is_same
        });
    }

    /// Coefficient of a sender, found once.
    fn coefficient(
        &self,
        sender: usize,
        viewpoint: &Viewpoint,
        scratch: &mut PairScratch,
        cost: &mut GatherCost,
    ) -> Coefficient {
        if let Some(known) = scratch.known.get(&(sender as u32)) {
            return *known;
        }
        let PairScratch { hits, has_hits, .. } = scratch;
        let near = |squared: f32| {
            if !*has_hits {
                let directions = &self.pairwise.near_directions[self.level];
                cost.rays += directions.len() as u64;
                hits.cast(self.context, self.receiver, directions, self.pairwise.farthest);
                *has_hits = true;
            }
            hits.near(sender, squared)
        };
        let (surfaces, dual) = (self.context.surfaces, self.context.duals[sender]);
        let found = coefficient(surfaces, &self.pairwise.quadrature, viewpoint, sender, dual, near);
        cost.rays += found.rays as u64;
        scratch.known.insert(sender as u32, found);
        found
    }

    /// What the oracle is told of a link with this amount.
    fn inspection(
        &self,
        sender: usize,
        link: &OpenLink,
        amount: f32,
        found: &Coefficient,
        ends: &Ends,
        cost: &mut GatherCost,
    ) -> Inspection {
        let (over_receiver, strongest, rays) = self.over_children(sender, found, &ends.children);
        cost.rays += rays;
        let has_children = !self.pairwise.sender_children.of(sender).is_empty();
        let is_refinable = has_children && link.share > LEAST_SHARE;
        Inspection {
            over_sender: if is_refinable {
                (link.share * found.deviation).max(UNKNOWN_LIGHT * amount.max(link.predicted))
            } else {
                0.0
            },
            over_receiver: link.share * over_receiver,
            magnitude: amount.max(link.predicted).max(link.share * strongest),
        }
    }

    /// At most [`PLACES`] of the receiver's children, spread over all of them.
    fn children(&self) -> Vec<Viewpoint> {
        let all = self.pairwise.receiver_children.of(self.receiver);
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
        let quadrature = &self.pairwise.quadrature;
        if children.is_empty() || quadrature.area(sender) <= 0.0 {
            return (0.0, 0.0, 0);
        }
        let (mut squares, mut all, mut seen, mut strongest, mut rays) = (0.0, 0.0, 0.0, 0f32, 0);
        for (k, child) in children.iter().enumerate() {
            let open = unoccluded(quadrature, child, sender);
            squares += (open - found.open).powi(2);
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
        let visible = (seen + found.seen) / (all + found.open).max(f32::MIN_POSITIVE);
        let visible = visible.clamp(0.0, 1.0);
        let hidden = mean * mean * visible * (1.0 - visible);
        ((visible * visible * squares / count + hidden).sqrt(), strongest, rays)
    }
}
