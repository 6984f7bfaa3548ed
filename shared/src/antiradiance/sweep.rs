//! Ordered iteration: radiance and antiradiance of a bin from one end of the scene to the other.
//!
//! The light of a bin goes one way. Elements in the order of that way have, when their turn comes, all the radiance and all
//! the antiradiance that comes to them: one sweep over the links is U(L − A) with the A of this L, for which the
//! antiradiance paper takes as many steps as surfaces lie behind each other (Eq. 9). Steps overshoot besides: the light
//! behind n surfaces grows to binomial coefficients of n before it ends, and together with reflection it may never; a sweep
//! subtracts from each surface what is left for it. Bins are independent of each other.
//!
//! A table has a row for each bin here: exitant intensity of all elements, then incident radiance of all.

use super::bins::Bins;
use super::cosines::BinCosines;
use super::hierarchy::{Element, Hierarchy, NONE};
use super::leaving::Leaving;
use super::local::{LocalPatch, exitant};
use super::patches::Patch;
use super::transfers::Transfers;
use super::workers::Workers;
use glam::Vec3;

/// Links by bin and receiver, and the order of the elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sweep {
    /// Elements by bin, in the order of the light's way; parents before their children.
    pub order: Vec<u32>,
    /// First link of each bin and element, and the number of links at the end.
    pub offsets: Vec<u32>,
    /// Senders.
    pub senders: Vec<u32>,
    /// Their form factors.
    pub factors: Vec<f32>,
}

/// What a sweep works on.
#[derive(Clone, Copy)]
pub struct SweepScene<'a> {
    /// Patches.
    pub patches: &'a [Patch],
    /// Elements.
    pub hierarchy: &'a Hierarchy,
    /// Directions.
    pub bins: &'a Bins,
    /// By patch: see [`normalisation`](super::cosines::normalisation).
    pub normalisations: &'a [f32],
}

impl<'a> SweepScene<'a> {
    /// A patch, for the local pass.
    pub fn local(&self, patch: usize) -> LocalPatch<'a> {
        LocalPatch { patch: &self.patches[patch], normalisation: self.normalisations[patch], bins: self.bins }
    }
}

impl Sweep {
    /// Sorts transfers by bin. Those that are [spread](super::spread) to other bins count for their own alone.
    pub fn new(scene: &SweepScene<'_>, transfers: &Transfers) -> Self {
        let (count, elements) = (scene.bins.count(), &scene.hierarchy.elements);
        let cells = elements.len() * count;
        let mut offsets = vec![0u32; cells + 1];
        let cell = |bin: usize, receiver: usize| bin * elements.len() + receiver;
        for receiver in 0..elements.len() {
            transfers.to(receiver).iter().for_each(|own| offsets[cell(own.bin(), receiver) + 1] += 1);
        }
        for i in 0..cells {
            offsets[i + 1] += offsets[i];
        }
        let mut next = offsets.clone();
        let mut senders = vec![0; transfers.transfers.len()];
        let mut factors = vec![0.0; transfers.transfers.len()];
        for receiver in 0..elements.len() {
            for own in transfers.to(receiver) {
                let at = &mut next[cell(own.bin(), receiver)];
                senders[*at as usize] = own.sender;
                factors[*at as usize] = own.factor;
                *at += 1;
            }
        }
        let mut order = Vec::with_capacity(cells);
        let all: Vec<u32> = (0..elements.len() as u32).collect();
        for way in &scene.bins.directions {
            order.extend(ordered(elements, &all, *way));
        }
        Self { order, offsets, senders, factors }
    }

    /// Incident radiance of all elements for the radiance that leaves patches, in all bins. Of links against the order there
    /// are few, between patches wider than their distance; they have the antiradiance of the sweep before.
    pub fn run(
        &self,
        scene: &SweepScene<'_>,
        radiance: &Leaving<'_>,
        table: &mut [Vec3],
        workers: &dyn Workers,
    ) {
        let elements = &scene.hierarchy.elements;
        workers.rows(table, 2 * elements.len(), &|bin, row| {
            let (leaving, incident) = row.split_at_mut(elements.len());
            let (way, sine) = (scene.bins.directions[bin], scene.bins.sine());
            let intensity = |element: &Element, incident: Vec3| {
                let patch = element.first as usize;
                let cosines = BinCosines::new(element.normal.dot(way), sine);
                let area = scene.normalisations[patch] * element.area;
                exitant(area, cosines, radiance.by(element, bin), incident)
            };
            for (i, element) in elements.iter().enumerate().rev() {
                leaving[i] = if element.is_patch() {
                    intensity(element, incident[i])
                } else {
                    leaving[element.children()].iter().sum()
                };
            }
            for receiver in &self.order[bin * elements.len()..][..elements.len()] {
                let receiver = *receiver as usize;
                let cell = bin * elements.len() + receiver;
                let own = self.offsets[cell] as usize..self.offsets[cell + 1] as usize;
                let links = self.senders[own.clone()].iter().zip(&self.factors[own]);
                let mut light: Vec3 = links.map(|(sender, factor)| *factor * leaving[*sender as usize]).sum();
                let element = &elements[receiver];
                if element.parent != NONE {
                    let share = if element.is_patch() {
                        BinCosines::new(element.normal.dot(way), sine).share
                    } else {
                        1.0
                    };
                    light += share * incident[element.parent as usize];
                }
                incident[receiver] = light;
                if element.is_patch() {
                    let change = intensity(element, light) - leaving[receiver];
                    let mut at = receiver as u32;
                    while at != NONE {
                        leaving[at as usize] += change;
                        at = elements[at as usize].parent;
                    }
                }
            }
        });
    }

    /// Irradiance of the patches after a sweep.
    pub fn irradiance(
        scene: &SweepScene<'_>,
        table: &[Vec3],
        irradiance: &mut [Vec3],
        workers: &dyn Workers,
    ) {
        workers.rows(irradiance, 1, &|patch, out| {
            out[0] = scene.local(patch).irradiance(Self::incident(scene, table, patch));
        });
    }

    /// Incident radiance of a patch by bin.
    pub fn incident<'a>(
        scene: &SweepScene<'a>,
        table: &'a [Vec3],
        patch: usize,
    ) -> impl Iterator<Item = Vec3> + use<'a> {
        let count = scene.hierarchy.elements.len();
        let element = scene.hierarchy.element_of[patch] as usize;
        (0..scene.bins.count()).map(move |bin| table[(2 * bin + 1) * count + element])
    }
}

/// Elements of whole subtrees, given by their rising indices, by the first of their patches along a way; parents before children.
pub(super) fn ordered(elements: &[Element], of: &[u32], way: Vec3) -> Vec<u32> {
    let mut first = vec![f32::INFINITY; elements.len()];
    for i in of.iter().rev().map(|i| *i as usize) {
        let element = &elements[i];
        first[i] = if element.is_patch() {
            element.position.dot(way)
        } else {
            first[element.children()].iter().fold(f32::INFINITY, |least, own| least.min(*own))
        };
    }
    let mut order = of.to_vec();
    order.sort_unstable_by(|a, b| first[*a as usize].total_cmp(&first[*b as usize]).then_with(|| a.cmp(b)));
    order
}
