//! Form factors of links: from which bin of the sender how much light comes to which bins of the receiver (antiradiance
//! paper, section 3.1, Eq. 17).
//!
//! A sender is infinitely small in the paper's 1 / (d² ω). Here it has its projected area: 1 / ((d² + ¾ a/π) ω), the solid
//! angle of a disc to the second order, which stays below that of a half space where patches touch.

use super::bins::Bins;
use super::cosines::{BinCosines, normalisation};
use super::hierarchy::{Element, Hierarchy};
use super::links::{GRAZING, Links};
use super::patches::Patch;
use super::samples::{FEW, MANY, Samples};
use super::spread::Spread;
use super::transfer::{BIN_BITS, Transfer};
use super::workers::Workers;
use glam::{Vec3, Vec4};
use std::f32::consts::{FRAC_1_PI, PI};

/// Solid angles of a sender, in bins, above which it has 4, 16, 64 and 256 samples: four in each bin or more. With fewer, a
/// bin has none of them or several; behind surfaces near each other such noise grows.
const WIDE: [f32; 4] = [0.05, 0.7, 4.0, 16.0];

/// How the light of a sender that is wider than a bin comes to several.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Spreading {
    /// Each bin of the cone of the sender gives its own light to the same bin of the receiver; the solid angles are
    /// those of samples of the sender.
    #[default]
    Exact,
    /// The bin in the direction of the middles gives its light to the neighbours too, by a Gaussian: one transfer a link.
    Gaussian,
}

/// Transfers by receiver.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Transfers {
    /// First transfer of each element, and the number of transfers at the end.
    pub offsets: Vec<u32>,
    /// Transfers.
    pub transfers: Vec<Transfer>,
}

impl Transfers {
    /// Computes those of all links.
    pub fn new(exchange: &Exchange<'_>, links: &Links, workers: &dyn Workers) -> Self {
        let count = exchange.hierarchy.elements.len();
        let rows = workers.lists(count, &|receiver| {
            let mut out = Vec::new();
            links.of(receiver).iter().for_each(|sender| exchange.add(receiver, *sender as usize, &mut out));
            out
        });
        let mut offsets = Vec::with_capacity(count + 1);
        offsets.push(0);
        let mut transfers = Vec::with_capacity(rows.iter().map(Vec::len).sum());
        for row in rows {
            transfers.extend_from_slice(&row);
            offsets.push(transfers.len() as u32);
        }
        Self { offsets, transfers }
    }

    /// These and others of the same elements.
    pub fn and(&self, others: &Self) -> Self {
        let mut out = Self { offsets: vec![0], ..Self::default() };
        for receiver in 0..self.offsets.len().max(1) - 1 {
            [self, others].iter().for_each(|own| out.transfers.extend_from_slice(own.to(receiver)));
            out.offsets.push(out.transfers.len() as u32);
        }
        out
    }

    /// Transfers to a receiver.
    pub fn to(&self, receiver: usize) -> &[Transfer] {
        &self.transfers[self.offsets[receiver] as usize..self.offsets[receiver + 1] as usize]
    }
}

/// What form factors need of senders beside their elements.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SenderTables {
    samples: Samples,
    /// By patch: see [`normalisation`].
    pub normalisations: Vec<f32>,
    /// By element and bin, one over the cosine that its intensity has; 1 of what is not flat.
    corrections: Vec<f32>,
    /// Index of a patch of each element.
    first_patch: Vec<u32>,
}

impl SenderTables {
    /// Those of all elements.
    pub fn new(patches: &[Patch], hierarchy: &Hierarchy, bins: &Bins) -> Self {
        let normalisations = patches.iter().map(|patch| normalisation(bins, patch.normal)).collect();
        let samples = Samples::new(patches, hierarchy);
        let mut first_patch = vec![0; hierarchy.elements.len()];
        for (i, element) in hierarchy.elements.iter().enumerate().rev() {
            let first = element.first as usize;
            first_patch[i] = if element.is_patch() { element.first } else { first_patch[first] };
        }
        let corrections = vec![1.0; hierarchy.elements.len() * bins.count()];
        let mut out = Self { samples, normalisations, corrections, first_patch };
        (0..hierarchy.elements.len()).for_each(|i| out.correct(&hierarchy.elements[i], bins, i));
        out
    }

    fn correct(&mut self, element: &Element, bins: &Bins, i: usize) {
        let row = &mut self.corrections[i * bins.count()..][..bins.count()];
        if !element.is_flat() {
            return row.fill(1.0);
        }
        let normalisation = self.normalisations[self.first_patch[i] as usize];
        for (out, way) in row.iter_mut().zip(&bins.directions) {
            let mean = BinCosines::new(element.normal.dot(*way), bins.sine()).both();
            *out = 1.0 / (normalisation * mean).max(GRAZING);
        }
    }

    /// Computes them anew for elements that have moved.
    pub fn follow(&mut self, patches: &[Patch], hierarchy: &Hierarchy, bins: &Bins, moved: &[u32]) {
        for i in moved {
            self.samples.follow(patches, hierarchy, *i as usize);
            let element = &hierarchy.elements[*i as usize];
            if element.is_patch() {
                let patch = element.first as usize;
                self.normalisations[patch] = normalisation(bins, patches[patch].normal);
            }
        }
        moved.iter().map(|i| *i as usize).for_each(|i| self.correct(&hierarchy.elements[i], bins, i));
    }
}

/// What form factors are computed from.
pub struct Exchange<'a> {
    /// Directions.
    pub bins: &'a Bins,
    /// Patches.
    pub patches: &'a [Patch],
    /// Elements.
    pub hierarchy: &'a Hierarchy,
    /// Of the same elements.
    pub senders: &'a SenderTables,
    /// How wide senders reach several bins.
    pub spreading: Spreading,
}

impl Exchange<'_> {
    /// Adds the transfers of a link.
    pub fn add(&self, receiver: usize, sender: usize, out: &mut Vec<Transfer>) {
        let [to, from] = [receiver, sender].map(|i| &self.hierarchy.elements[i]);
        let square = to.position.distance_squared(from.position);
        let solid_angle = PI * from.radius * from.radius / square.max(f32::MIN_POSITIVE);
        let ratio = solid_angle / self.bins.solid_angle();
        let middle = [from.position.extend(1.0)];
        let is_exact = self.spreading == Spreading::Exact;
        let (near, very_near): ([Vec4; 64], [Vec4; 256]);
        let wide = if is_exact { WIDE.iter().take_while(|least| ratio > **least).count() } else { 0 };
        let places: &[Vec4] = match wide {
            0 => &middle,
            1 => self.senders.samples.of(sender, FEW),
            3 if from.is_patch() => {
                near =
                    self.patches[from.first as usize].sixty_fourths().map(|place| place.extend(1.0 / 64.0));
                &near
            }
            4 if from.is_patch() => {
                let places = self.patches[from.first as usize].two_hundred_fifty_sixths();
                very_near = places.map(|place| place.extend(1.0 / 256.0));
                &very_near
            }
            _ => self.senders.samples.of(sender, MANY),
        };
        let width = if is_exact { 0 } else { Spread::width(self.bins, from.area / square) };
        let begin = out.len();
        for place in places.iter().filter(|place| place.w > 0.0) {
            let Some((bin, factor)) = self.form_factor(to, sender, *place) else { continue };
            let bins = bin as u32 | (width as u32) << BIN_BITS;
            if let Some(same) = out[begin..].iter_mut().find(|transfer| transfer.bins == bins) {
                same.factor += factor;
            } else {
                out.push(Transfer { sender: sender as u32, bins, factor });
            }
        }
    }

    /// The bin of the light from a place on the sender, and its form factor; `None` if it does not come to the front, or
    /// against the way from middle to middle: patches wider than their distance would send each other light of one bin,
    /// round and round, and antiradiance would not come to an end.
    fn form_factor(&self, to: &Element, sender: usize, place: Vec4) -> Option<(usize, f32)> {
        let way = to.position - place.truncate();
        let square = way.length_squared();
        let direction = way / square.sqrt().max(f32::MIN_POSITIVE);
        if to.is_flat() && to.normal.dot(-direction) <= GRAZING {
            return None;
        }
        let bin = self.bins.bin_of(direction);
        let from = &self.hierarchy.elements[sender];
        if self.bins.directions[bin].dot(to.position - from.position) <= 0.0 {
            return None;
        }
        let (cosine, correction) = self.cosine(sender, direction, bin)?;
        let own = 0.75 * FRAC_1_PI * place.w * from.area * cosine;
        Some((bin, correction * place.w / ((square + own) * self.bins.solid_angle())))
    }

    /// Cosine of a sender in a direction, and the same over the one that its intensity in the bin has: the solid angle is
    /// then the true one. Of one that is not flat both are 1. `None` along its plane.
    fn cosine(&self, sender: usize, direction: Vec3, bin: usize) -> Option<(f32, f32)> {
        let from = &self.hierarchy.elements[sender];
        if !from.is_flat() {
            return Some((1.0, 1.0));
        }
        let cosine = from.normal.dot(direction).abs();
        let correction = self.senders.corrections[sender * self.bins.count() + bin];
        (cosine > GRAZING).then_some((cosine, cosine * correction))
    }
}
