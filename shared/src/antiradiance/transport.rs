//! The global pass: unoccluded transport U over links, push and pull (antiradiance paper, sections 3.1 and 3.2).
//!
//! Tables have a row for each element and a column for each bin; a bin is the way that light goes, for senders and
//! receivers alike.

use super::bins::Bins;
use super::cosines::BinCosines;
use super::hierarchy::Hierarchy;
use super::patches::Patch;
use super::spread::Spread;
use super::transfers::Transfers;
use super::workers::Workers;
use glam::Vec3;

/// Light over links: incident radiance of all elements from the exitant intensity of all.
pub fn global_pass(
    transfers: &Transfers,
    spread: &Spread,
    bins: usize,
    exitant: &[Vec3],
    incident: &mut [Vec3],
    workers: &dyn Workers,
) {
    workers.rows(incident, bins, &|receiver, row| {
        row.fill(Vec3::ZERO);
        for transfer in transfers.to(receiver) {
            let bin = transfer.bin();
            let light = transfer.factor * exitant[transfer.sender as usize * bins + bin];
            match transfer.width() {
                0 => row[bin] += light,
                width => spread.of(bins, bin, width).for_each(|(to, share)| row[to] += share * light),
            }
        }
    });
}

/// Push: the light of clusters comes to all their children. A patch has the part that comes to its front.
pub fn push(
    patches: &[Patch],
    hierarchy: &Hierarchy,
    bins: &Bins,
    incident: &mut [Vec3],
    workers: &dyn Workers,
) {
    let (count, sine) = (bins.count(), bins.sine());
    for level in 1..hierarchy.depth() {
        let own = hierarchy.level(level);
        let (above, below) = incident.split_at_mut(own.start * count);
        workers.rows(&mut below[..own.len() * count], count, &|i, row| {
            let element = &hierarchy.elements[own.start + i];
            let parent = &above[element.parent as usize * count..][..count];
            if !element.is_patch() {
                row.iter_mut().zip(parent).for_each(|(own, parent)| *own += *parent);
                return;
            }
            let normal = patches[element.first as usize].normal;
            for ((own, parent), way) in row.iter_mut().zip(parent).zip(&bins.directions) {
                *own += BinCosines::new(normal.dot(*way), sine).share * *parent;
            }
        });
    }
}

/// Pull: the intensity of a cluster is the sum of its children's.
pub fn pull(hierarchy: &Hierarchy, bins: usize, exitant: &mut [Vec3], workers: &dyn Workers) {
    for level in (0..hierarchy.depth().saturating_sub(1)).rev() {
        let own = hierarchy.level(level);
        let (above, below) = exitant.split_at_mut(own.end * bins);
        workers.rows(&mut above[own.start * bins..], bins, &|i, row| {
            let element = &hierarchy.elements[own.start + i];
            if element.is_patch() {
                return;
            }
            row.fill(Vec3::ZERO);
            for child in element.children() {
                let child = &below[(child - own.end) * bins..][..bins];
                row.iter_mut().zip(child).for_each(|(own, child)| *own += *child);
            }
        });
    }
}
