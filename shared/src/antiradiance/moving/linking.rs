//! Links between what stands, piece by piece: a page goes on drawing meanwhile.

use super::super::cells::Cells;
use super::super::links::{Links, Pairs};
use super::super::patches::Patch;
use super::super::solve::SolverSettings;
use super::super::transfers::Transfers;
use super::super::waves::Turns;
use super::super::workers::Serial;
use super::{MovingElements, PartTables};

/// Links that form factors are computed of, in the time in which this many pairs are refined.
const PAIRS_A_LINK: usize = 16;
/// Cells that have their turn in that time.
const CELLS_A_LINK: usize = 4;

/// Elements whose links are on their way.
pub struct Linking {
    elements: MovingElements,
    stage: Stage,
}

enum Stage {
    /// Refinement.
    Pairs(Pairs),
    /// Form factors by receiver; those of so many are there.
    Transfers(Links, usize),
    /// Turns of a sweep, by bin.
    Turns(Cells, Turns, usize),
}

impl Linking {
    /// Elements of patches of which the first `still` stand.
    pub fn new(patches: Vec<Patch>, still: usize, settings: SolverSettings) -> Self {
        let elements = MovingElements::unlinked(patches, still, settings);
        let pairs = Pairs { open: elements.within_still(), found: Vec::new() };
        Self { elements, stage: Stage::Pairs(pairs) }
    }

    /// Goes on for the time of form factors of about `work` links. Returns the elements when all links are there, with the tables of
    /// what stands; else itself.
    ///
    /// # Errors
    /// Itself, which is not done.
    pub fn advance(mut self, work: usize) -> Result<(MovingElements, PartTables), Self> {
        let mut left = work.max(1);
        while left > 0 {
            let (stage, taken) = match self.stage {
                Stage::Pairs(pairs) => self.elements.refined(pairs, left),
                Stage::Transfers(links, next) => self.elements.with_transfers(links, next, left),
                Stage::Turns(cells, turns, bin) if bin == self.elements.bins.count() => {
                    self.elements.link(&Serial);
                    return Ok((self.elements, PartTables { cells, waves: turns.waves() }));
                }
                Stage::Turns(cells, turns, bin) => self.elements.with_turns(cells, turns, bin),
            };
            self.stage = stage;
            left = left.saturating_sub(taken);
        }
        Err(self)
    }
}

impl MovingElements {
    /// The next stage of a refinement, and the work that it took.
    fn refined(&mut self, mut pairs: Pairs, work: usize) -> (Stage, usize) {
        let Self { patches, hierarchy, bins, settings, .. } = &*self;
        pairs.refine(patches, (hierarchy, bins), settings.width, work.saturating_mul(PAIRS_A_LINK));
        if !pairs.open.is_empty() {
            return (Stage::Pairs(pairs), work);
        }
        let links = Links::of_pairs(hierarchy.elements.len(), &pairs.found);
        self.between_still = (Transfers { offsets: vec![0], transfers: Vec::new() }, links.count());
        (Stage::Transfers(links, 0), 1)
    }

    fn with_transfers(&mut self, links: Links, mut receiver: usize, work: usize) -> (Stage, usize) {
        let count = self.hierarchy.elements.len();
        let mut transfers = std::mem::take(&mut self.between_still.0);
        let mut taken = 0;
        while receiver < count && taken < work {
            let senders = links.of(receiver);
            senders.iter().for_each(|sender| {
                self.exchange().add(receiver, *sender as usize, &mut transfers.transfers);
            });
            transfers.offsets.push(transfers.transfers.len() as u32);
            taken += 1 + senders.len();
            receiver += 1;
        }
        self.between_still.0 = transfers;
        if receiver < count {
            return (Stage::Transfers(links, receiver), taken);
        }
        let cells = Cells::new(&self.between_still.0, None, &self.hierarchy, self.bins.count());
        (Stage::Turns(cells, Turns::default(), 0), taken)
    }

    fn with_turns(&self, cells: Cells, mut turns: Turns, bin: usize) -> (Stage, usize) {
        turns.add(&self.parts[0], &cells, (&self.hierarchy, &self.bins), bin);
        (Stage::Turns(cells, turns, bin + 1), 1 + self.parts[0].len() / CELLS_A_LINK)
    }
}
