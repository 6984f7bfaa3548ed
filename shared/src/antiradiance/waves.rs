//! The ordered iteration for many threads: what a [sweep](super::sweep) does one after the other, in waves.
//!
//! A wave is what may be done at once: cells whose senders, and whose cluster above, have had their turn in earlier waves.
//! There are as many as the longest chain of links, in all bins together; a sweep in order has as many turns as there are
//! elements. Where a sender comes after its receiver in the order, the receiver takes the light of the sweep before, and
//! the sender is in a later wave: each cell reads what the same waves have left there, whichever thread comes first.
//!
//! The order is for speed alone: sweeps in any order come to the same light. What moves has waves of its own, before those of what
//! stands ([`MovingElements`](super::MovingElements)): they are short, and those of what stands need not be made anew.
//!
//! Bins are independent of each other within a sweep. Items of a wave are sorted by slice of the bins ([`SLICES`]): a frame can sweep
//! one slice.

use super::bins::Bins;
use super::cells::Cells;
use super::hierarchy::{Hierarchy, NONE};
use super::sweep::ordered;
use std::ops::Range;

/// Bit of an item that is the sum of a cluster's children.
pub const PULL: u32 = 1 << 31;

/// Number of slices of the bins. Bin b is in slice b mod `SLICES`: a slice has directions all around.
pub const SLICES: usize = 4;

/// Cells of the tables, wave by wave.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Waves {
    /// First item of each wave and slice, slice by slice in each wave, and the number of items at the end.
    starts: Vec<u32>,
    /// Cells whose light is gathered, and, with the bit [`PULL`], clusters whose children have all had their turn.
    pub items: Vec<u32>,
}

impl Waves {
    /// Sorts all cells into waves.
    pub fn new(cells: &Cells, hierarchy: &Hierarchy, bins: &Bins) -> Self {
        let all: Vec<u32> = (0..hierarchy.elements.len() as u32).collect();
        Self::of_elements(&all, cells, hierarchy, bins)
    }

    /// Sorts the cells of some elements into waves: whole subtrees, by their rising indices. Light of all other elements is there before
    /// the first wave.
    pub fn of_elements(elements: &[u32], cells: &Cells, hierarchy: &Hierarchy, bins: &Bins) -> Self {
        let mut turns = Turns::default();
        (0..bins.count()).for_each(|bin| turns.add(elements, cells, (hierarchy, bins), bin));
        turns.waves()
    }

    /// Threads of a group take as long as the longest of them: items of a wave are in the order of their links.
    fn of_turns(turns: &[Turn]) -> Self {
        let waves = turns.iter().map(|turn| turn.wave).max().unwrap_or(0) as usize;
        let mut starts = vec![0u32; waves * SLICES + 1];
        // Waves count from 1.
        let place = |turn: &Turn| (turn.wave as usize - 1) * SLICES + turn.slice as usize;
        turns.iter().for_each(|turn| starts[place(turn) + 1] += 1);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut items = vec![(0, 0); turns.len()];
        for turn in turns {
            let at = &mut next[place(turn)];
            items[*at as usize] = (u32::MAX - turn.links, turn.item);
            *at += 1;
        }
        for slice in starts.windows(2) {
            items[slice[0] as usize..slice[1] as usize].sort_unstable();
        }
        Self { starts, items: items.iter().map(|(_, item)| *item).collect() }
    }

    /// Number of waves.
    pub fn count(&self) -> usize {
        self.starts.len() / SLICES
    }

    /// Indices of the items of a wave.
    pub fn range(&self, wave: usize) -> Range<usize> {
        self.starts[wave * SLICES] as usize..self.starts[(wave + 1) * SLICES] as usize
    }

    /// Indices of the items of a wave that are of a slice of the bins.
    pub fn slice(&self, wave: usize, slice: usize) -> Range<usize> {
        let at = wave * SLICES + slice;
        self.starts[at] as usize..self.starts[at + 1] as usize
    }

    /// Items of a wave.
    pub fn of(&self, wave: usize) -> &[u32] {
        &self.items[self.range(wave)]
    }
}

/// Items of some bins, before they are sorted into waves.
#[derive(Clone, Debug, Default)]
pub struct Turns(Vec<Turn>);

impl Turns {
    /// Adds those of a bin, which is independent of all others; `of` is as in [`Waves::of_elements`].
    pub fn add(&mut self, of: &[u32], cells: &Cells, (hierarchy, bins): (&Hierarchy, &Bins), bin: usize) {
        BinTurns::new(of, cells, hierarchy, bins, bin).run(&mut self.0);
    }

    /// Sorts them.
    pub fn waves(&self) -> Waves {
        Waves::of_turns(&self.0)
    }
}

/// An item, and its wave; waves count from 1.
#[derive(Clone, Copy, Debug)]
struct Turn {
    wave: u32,
    item: u32,
    /// Number of links of the item.
    links: u32,
    /// Slice of its bin.
    slice: u8,
}

/// Turns of the elements in a bin.
struct BinTurns<'a> {
    cells: &'a Cells,
    hierarchy: &'a Hierarchy,
    bins: usize,
    bin: usize,
    order: Vec<u32>,
    /// Wave after which incident light is there, 0 before its turn.
    received: Vec<u32>,
    /// Wave after which exitant light is there, 0 before its turn.
    left: Vec<u32>,
    /// Last wave that reads the exitant light of the sweep before.
    read: Vec<u32>,
    /// Children that have not had their turn.
    remaining: Vec<u32>,
}

impl<'a> BinTurns<'a> {
    fn new(of: &[u32], cells: &'a Cells, hierarchy: &'a Hierarchy, bins: &Bins, bin: usize) -> Self {
        let elements = &hierarchy.elements;
        let none = || vec![0u32; elements.len()];
        Self {
            cells,
            hierarchy,
            bins: bins.count(),
            bin,
            order: ordered(elements, of, bins.directions[bin]),
            received: none(),
            left: none(),
            read: none(),
            remaining: elements.iter().map(|element| element.children).collect(),
        }
    }

    fn run(mut self, out: &mut Vec<Turn>) {
        let elements = &self.hierarchy.elements;
        let slice = (self.bin % SLICES) as u8;
        for own in std::mem::take(&mut self.order) {
            let own = own as usize;
            let element = &elements[own];
            let cell = own * self.bins + self.bin;
            let senders = self.cells.of(cell).iter().map(|transfer| transfer.from as usize / self.bins);
            let mut last = if element.parent == NONE { 0 } else { self.received[element.parent as usize] };
            for sender in senders.clone() {
                last = last.max(self.left[sender]);
            }
            if element.is_patch() {
                last = last.max(self.read[own]);
            }
            let wave = last + 1;
            self.received[own] = wave;
            out.push(Turn { wave, item: cell as u32, links: self.cells.of(cell).len() as u32, slice });
            for sender in senders.filter(|sender| self.left[*sender] == 0) {
                self.read[sender] = self.read[sender].max(wave);
            }
            if element.is_patch() {
                self.left[own] = wave;
                self.pull(element.parent, out);
            }
        }
    }

    /// A child of a cluster has had its turn.
    fn pull(&mut self, mut cluster: u32, out: &mut Vec<Turn>) {
        let slice = (self.bin % SLICES) as u8;
        while cluster != NONE {
            let own = cluster as usize;
            self.remaining[own] -= 1;
            if self.remaining[own] > 0 {
                return;
            }
            let element = &self.hierarchy.elements[own];
            let children = element.children().map(|child| self.left[child]);
            let wave = children.fold(self.read[own], u32::max) + 1;
            self.left[own] = wave;
            out.push(Turn { wave, item: (own * self.bins + self.bin) as u32 | PULL, links: 0, slice });
            cluster = element.parent;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{AntiradianceSolver, Patch, Serial, SolverSettings};
    use super::*;
    use crate::random::Stream;
    use glam::Vec3;

    #[test]
    fn every_cell_has_its_turn_once_and_reads_what_no_item_of_its_wave_writes() {
        let mut stream = Stream::new(1, 13);
        let patches: Vec<Patch> = (0..200)
            .map(|_| Patch::around(stream.sphere(), stream.sphere(), 0.02 + 0.1 * stream.unit(), Vec3::ONE))
            .collect();
        let settings = SolverSettings { bins: 64, ..SolverSettings::default() };
        let solver = AntiradianceSolver::new(&patches, &settings, &Serial);
        let AntiradianceSolver { hierarchy, transfers, bins, .. } = &solver;
        let count = bins.count();
        let cells = Cells::new(transfers, None, hierarchy, count);
        let waves = Waves::new(&cells, hierarchy, bins);
        let all = hierarchy.elements.len() * count;
        let (mut written, mut left) = (vec![0usize; all], vec![0usize; all]);
        for wave in 0..waves.count() {
            for slice in 0..SLICES {
                let items = &waves.items[waves.slice(wave, slice)];
                assert!(items.iter().all(|item| (item & !PULL) as usize % count % SLICES == slice));
            }
            for item in waves.of(wave) {
                let cell = (item & !PULL) as usize;
                let is_patch = hierarchy.elements[cell / count].is_patch();
                if item & PULL == 0 {
                    assert_eq!(std::mem::replace(&mut written[cell], wave + 1), 0);
                }
                if item & PULL != 0 || is_patch {
                    assert_eq!(std::mem::replace(&mut left[cell], wave + 1), 0);
                }
            }
        }
        assert!(written.iter().chain(&left).all(|wave| *wave > 0), "a cell has no turn");
        let (mut late, mut links) = (0, 0);
        for cell in 0..all {
            let (own, bin) = (cell / count, cell % count);
            let element = &hierarchy.elements[own];
            if element.parent != NONE {
                assert!(written[element.parent as usize * count + bin] < written[cell]);
            }
            for child in element.children() {
                assert!(left[child * count + bin] < left[cell]);
            }
            for transfer in cells.of(cell) {
                assert_ne!(left[transfer.from as usize], written[cell], "read and written at once");
                links += 1;
                late += usize::from(left[transfer.from as usize] > written[cell]);
            }
        }
        println!(
            "{} waves of {} elements; {late} of {links} links late",
            waves.count(),
            hierarchy.elements.len()
        );
        assert!(waves.count() < hierarchy.elements.len() / 2 && late < links / 5, "{late} of {links}");
    }
}
