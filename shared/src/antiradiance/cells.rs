//! Transfers by cell of the table of incident radiance: one receiver, one bin. What a GPU gathers, a thread a cell.
//!
//! Of a sender the table of exitant radiance has the intensity by the square unit of its area: half floats hold it for
//! patches and for the whole scene alike.

use super::hierarchy::Hierarchy;
use super::spread::Spread;
use super::transfers::Transfers;
use bytemuck::{Pod, Zeroable};

/// A transfer to a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct CellTransfer {
    /// Cell of the sender: its element times the number of bins, and the bin.
    pub from: u32,
    /// Incident radiance per exitant intensity by area.
    pub factor: f32,
}

/// Transfers by cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cells {
    /// First transfer of each element and bin, element after element, and the number of transfers at the end.
    pub offsets: Vec<u32>,
    /// Transfers.
    pub transfers: Vec<CellTransfer>,
}

impl Cells {
    /// Sorts transfers by cell. With a spread, one that is [spread](super::spread) is in all the bins that it reaches.
    pub fn new(transfers: &Transfers, spread: Option<&Spread>, hierarchy: &Hierarchy, bins: usize) -> Self {
        let elements = &hierarchy.elements;
        let mut offsets = vec![0u32; elements.len() * bins + 1];
        let each = |add: &mut dyn FnMut(usize, CellTransfer)| {
            for receiver in 0..elements.len() {
                for own in transfers.to(receiver) {
                    let from = own.sender * bins as u32 + own.bin() as u32;
                    let factor = own.factor * elements[own.sender as usize].area;
                    let mut to = |(bin, share): (usize, f32)| {
                        add(receiver * bins + bin, CellTransfer { from, factor: share * factor });
                    };
                    match spread {
                        Some(spread) => spread.of(bins, own.bin(), own.width()).for_each(to),
                        None => to((own.bin(), 1.0)),
                    }
                }
            }
        };
        each(&mut |cell, _| offsets[cell + 1] += 1);
        for i in 1..offsets.len() {
            offsets[i] += offsets[i - 1];
        }
        let mut next = offsets.clone();
        let mut out = vec![CellTransfer::default(); offsets.last().map_or(0, |count| *count as usize)];
        each(&mut |cell, transfer| {
            out[next[cell] as usize] = transfer;
            next[cell] += 1;
        });
        Self { offsets, transfers: out }
    }

    /// Transfers to a cell.
    pub fn of(&self, cell: usize) -> &[CellTransfer] {
        &self.transfers[self.offsets[cell] as usize..self.offsets[cell + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::super::transport::global_pass;
    use super::super::{AntiradianceSolver, Patch, Serial, SolverSettings, Spreading};
    use super::*;
    use crate::random::Stream;
    use glam::Vec3;

    #[test]
    fn cells_gather_what_the_global_pass_brings() {
        let mut stream = Stream::new(1, 11);
        let patches: Vec<Patch> = (0..300)
            .map(|_| {
                let at = stream.sphere();
                Patch::around(at, -at, 0.02 + 0.04 * stream.unit(), Vec3::ONE)
            })
            .collect();
        for spreading in [Spreading::Exact, Spreading::Gaussian] {
            let settings = SolverSettings { bins: 64, spreading, ..SolverSettings::default() };
            let solver = AntiradianceSolver::new(&patches, &settings, &Serial);
            let AntiradianceSolver { hierarchy, transfers, spread, bins, .. } = &solver;
            let bins = bins.count();
            let exitant: Vec<Vec3> = (0..hierarchy.elements.len() * bins)
                .map(|_| Vec3::new(stream.unit(), stream.unit(), stream.unit()))
                .collect();
            let mut incident = vec![Vec3::ZERO; exitant.len()];
            global_pass(transfers, spread, bins, &exitant, &mut incident, &Serial);
            let cells = Cells::new(transfers, Some(spread), hierarchy, bins);
            for (cell, expected) in incident.iter().enumerate() {
                let found: Vec3 = cells
                    .of(cell)
                    .iter()
                    .map(|own| {
                        let area = hierarchy.elements[own.from as usize / bins].area;
                        own.factor / area * exitant[own.from as usize]
                    })
                    .sum();
                assert!(found.distance(*expected) <= 1e-4 * expected.length(), "{found} {expected}");
            }
        }
    }
}
