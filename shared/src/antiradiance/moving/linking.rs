//! Links piece by piece: a page goes on drawing meanwhile.

use super::super::cells::Cells;
use super::super::links::{Links, Pairs};
use super::super::patches::Patch;
use super::super::solve::SolverSettings;
use super::super::transfers::Transfers;
use super::super::waves::Turns;
use super::super::workers::Serial;
use super::{MovingElements, PartTables};

/// Pairs that are refined in the time in which the form factors of a link are computed.
const PAIRS_A_LINK: usize = 16;
/// Cells that are put into waves in the time in which the form factors of a link are computed.
const CELLS_A_LINK: usize = 4;

/// Unfinished links and form factors between pairs of elements.
pub(super) struct LinksInParts {
    stage: Stage,
    transfers: Transfers,
    links: usize,
}

enum Stage {
    /// Refinement.
    Pairs(Pairs),
    /// Form factors of the links; the index of the next receiver.
    Transfers(Links, usize),
}

impl LinksInParts {
    pub fn new(open: Vec<[usize; 2]>) -> Self {
        let stage = Stage::Pairs(Pairs { open, found: Vec::new() });
        Self { stage, transfers: Transfers { offsets: vec![0], transfers: Vec::new() }, links: 0 }
    }

    /// Computes about `work` links. Returns whether the links are complete, and the work done.
    fn advance(&mut self, elements: &MovingElements, work: usize) -> (bool, usize) {
        let MovingElements { patches, hierarchy, bins, settings, .. } = elements;
        let count = hierarchy.elements.len();
        let mut done = 0;
        while done < work {
            match &mut self.stage {
                Stage::Pairs(pairs) => {
                    let most = (work - done).saturating_mul(PAIRS_A_LINK);
                    pairs.refine(patches, (hierarchy, bins), settings.width, most);
                    if !pairs.open.is_empty() {
                        return (false, work);
                    }
                    let links = Links::of_pairs(count, &pairs.found);
                    self.links = links.count();
                    self.stage = Stage::Transfers(links, 0);
                    done += 1;
                }
                Stage::Transfers(_, receiver) if *receiver == count => return (true, done),
                Stage::Transfers(links, receiver) => {
                    let (exchange, senders) = (elements.exchange(), links.of(*receiver));
                    let Transfers { offsets, transfers } = &mut self.transfers;
                    senders.iter().for_each(|sender| exchange.add(*receiver, *sender as usize, transfers));
                    offsets.push(transfers.len() as u32);
                    done += 1 + senders.len();
                    *receiver += 1;
                }
            }
        }
        (false, done)
    }
}

/// Elements with unfinished links between what stands.
pub struct Linking {
    elements: MovingElements,
    stage: FirstStage,
}

enum FirstStage {
    /// Links between what stands.
    Links(LinksInParts),
    /// Turns of a sweep, by bin.
    Turns(Cells, Turns, usize),
}

impl Linking {
    /// Elements of patches of which the first `still` stand.
    pub fn new(patches: Vec<Patch>, still: usize, settings: SolverSettings) -> Box<Self> {
        let elements = MovingElements::unlinked(patches, still, settings);
        let stage = FirstStage::Links(LinksInParts::new(elements.within_still()));
        Box::new(Self { elements, stage })
    }

    /// Computes about `work` links. Returns the elements and the tables of what stands when the links are complete.
    ///
    /// # Errors
    /// The unfinished links.
    pub fn advance(mut self: Box<Self>, work: usize) -> Result<(MovingElements, PartTables), Box<Self>> {
        let mut left = work.max(1);
        while left > 0 {
            let elements = &mut self.elements;
            match &mut self.stage {
                FirstStage::Links(links) => {
                    let (is_done, done) = links.advance(elements, left);
                    left = left.saturating_sub(done);
                    if is_done {
                        elements.between_still = (std::mem::take(&mut links.transfers), links.links);
                        let transfers = &elements.between_still.0;
                        let cells = Cells::new(transfers, None, &elements.hierarchy, elements.bins.count());
                        self.stage = FirstStage::Turns(cells, Turns::default(), 0);
                    }
                }
                FirstStage::Turns(_, turns, bin) if *bin == elements.bins.count() => {
                    let waves = turns.waves();
                    elements.link(&Serial);
                    let FirstStage::Turns(cells, ..) = self.stage else { continue };
                    return Ok((self.elements, PartTables { cells, waves }));
                }
                FirstStage::Turns(cells, turns, bin) => {
                    turns.add(&elements.parts[0], cells, (&elements.hierarchy, &elements.bins), *bin);
                    left = left.saturating_sub(1 + elements.parts[0].len() / CELLS_A_LINK);
                    *bin += 1;
                }
            }
        }
        Err(self)
    }
}

impl MovingElements {
    /// Places the patches that move, in their order. [`Self::advance`] makes their links.
    pub fn begin_to_follow(&mut self, moved: &[Patch]) {
        self.place(moved);
        self.following = Some(LinksInParts::new(self.of_what_moves()));
    }

    /// Whether links of what moves are unfinished.
    pub fn is_following(&self) -> bool {
        self.following.is_some()
    }

    /// Computes about `work` links of what moves. Returns whether the links are complete.
    pub fn advance(&mut self, work: usize) -> bool {
        let Some(mut links) = self.following.take() else { return true };
        let (is_done, _) = links.advance(self, work.max(1));
        if is_done {
            self.of_moving = (links.transfers, links.links);
        } else {
            self.following = Some(links);
        }
        is_done
    }
}
