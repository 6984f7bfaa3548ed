//! Elements of which some move: links between what stands are made once, those of what moves after each motion (antiradiance
//! paper, section 3.3).
//!
//! What moves has a subtree of its own, whose clusters keep their children: elements keep their numbers, and light by element and
//! bin goes on from where it was. Links, and what orders them for a GPU, are apart for both parts ([`PartTables`]), so that the work
//! after a motion grows with what moves.

mod linking;

pub use linking::Linking;
use linking::LinksInParts;

use super::bins::Bins;
use super::cells::Cells;
use super::hierarchy::{Hierarchy, NONE};
use super::links::Links;
use super::lobe::Lobes;
use super::patches::Patch;
use super::solve::{AntiradianceSolver, SolverSettings};
use super::sweep::SweepScene;
use super::transfers::{Exchange, SenderTables, Transfers};
use super::waves::Waves;
use super::workers::Workers;
use std::ops::Range;

/// Roots of the static and of the moving subtree in a [`Hierarchy::parted`].
const STILL: usize = 1;
const MOVING: usize = 2;

/// Links of a part, for a GPU.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PartTables {
    /// Links by receiver and bin: between what stands, or those from and to what moves.
    pub cells: Cells,
    /// Turns of the part's elements in a sweep. What moves comes first, in the light that what stands had in the sweep before.
    pub waves: Waves,
}

/// Elements and links of a scene whose last patches move.
pub struct MovingElements {
    patches: Vec<Patch>,
    /// Number of patches that stand: the first ones.
    still: usize,
    settings: SolverSettings,
    bins: Bins,
    hierarchy: Hierarchy,
    /// Rising indices of the elements of both subtrees: of what stands, and of what moves.
    parts: [Vec<u32>; 2],
    /// Transfers between elements that stand, and the number of their links.
    between_still: (Transfers, usize),
    /// Transfers from and to elements that move, and the number of their links.
    of_moving: (Transfers, usize),
    /// Unfinished links of what moves.
    following: Option<LinksInParts>,
    senders: SenderTables,
    lobes: Lobes,
}

impl MovingElements {
    /// Makes hierarchy, links and form factors of patches of which the first `still` stand.
    pub fn new(patches: Vec<Patch>, still: usize, settings: SolverSettings, workers: &dyn Workers) -> Self {
        let mut out = Self::unlinked(patches, still, settings);
        out.between_still = out.transfers(out.within_still(), workers);
        out.link(workers);
        out
    }

    /// Without any links.
    fn unlinked(patches: Vec<Patch>, still: usize, settings: SolverSettings) -> Self {
        let hierarchy = Hierarchy::parted(&patches, still);
        let bins = Bins::new(settings.bins);
        let senders = SenderTables::new(&patches, &hierarchy, &bins);
        let lobes = Lobes::new(&patches, &bins, &senders.normalisations);
        let parts = parts(&hierarchy, still, patches.len());
        let (between_still, of_moving) = Default::default();
        let following = None;
        Self {
            patches,
            still,
            settings,
            bins,
            hierarchy,
            parts,
            between_still,
            of_moving,
            following,
            senders,
            lobes,
        }
    }

    /// Pairs of elements that links between what stands are refined from.
    fn within_still(&self) -> Vec<[usize; 2]> {
        match (self.still, self.patches.len()) {
            (0, _) => Vec::new(),
            (still, all) if still == all => vec![[0, 0]],
            _ => vec![[STILL, STILL]],
        }
    }

    /// Puts the patches that move elsewhere, in their order, and makes their links anew.
    pub fn follow(&mut self, moved: &[Patch], workers: &dyn Workers) {
        self.place(moved);
        self.following = None;
        self.link(workers);
    }

    fn place(&mut self, moved: &[Patch]) {
        self.patches[self.still..].copy_from_slice(moved);
        let Self { patches, still, bins, hierarchy, parts: [_, parts], senders, lobes, .. } = self;
        hierarchy.follow(patches, parts);
        senders.follow(patches, hierarchy, bins, parts);
        lobes.follow(patches, bins, &senders.normalisations, *still);
    }

    /// Patches: static ones first, then moving ones.
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// Numbers of the patches that move.
    pub fn moving(&self) -> Range<usize> {
        self.still..self.patches.len()
    }

    /// Patches, elements and bins.
    pub fn scene(&self) -> SweepScene<'_> {
        SweepScene {
            patches: &self.patches,
            hierarchy: &self.hierarchy,
            bins: &self.bins,
            normalisations: &self.senders.normalisations,
        }
    }

    /// Metals.
    pub fn lobes(&self) -> &Lobes {
        &self.lobes
    }

    /// Number of links between what stands, and of those from and to what moves.
    pub fn links(&self) -> [usize; 2] {
        [self.between_still.1, self.of_moving.1]
    }

    /// Links between what stands, for a GPU.
    pub fn still_tables(&self) -> PartTables {
        self.tables(&self.between_still.0, &self.parts[0])
    }

    /// Links of what moves, for a GPU.
    pub fn moving_tables(&self) -> PartTables {
        self.tables(&self.of_moving.0, &self.parts[1])
    }

    fn tables(&self, transfers: &Transfers, elements: &[u32]) -> PartTables {
        let cells = Cells::new(transfers, None, &self.hierarchy, self.bins.count());
        let waves = Waves::of_elements(elements, &cells, &self.hierarchy, &self.bins);
        PartTables { cells, waves }
    }

    /// A solver of the present elements and links.
    pub fn solver(&self) -> AntiradianceSolver<'_> {
        AntiradianceSolver::linked(
            &self.patches,
            (self.hierarchy.clone(), self.bins.clone()),
            (self.between_still.0.and(&self.of_moving.0), self.links().iter().sum()),
            (self.senders.normalisations.clone(), self.lobes.clone()),
        )
    }

    /// Transfers of the links between pairs of elements, and the number of links.
    fn transfers(&self, open: Vec<[usize; 2]>, workers: &dyn Workers) -> (Transfers, usize) {
        let Self { patches, hierarchy, bins, settings, .. } = self;
        let links = Links::between(patches, hierarchy, bins, settings.width, open);
        (Transfers::new(&self.exchange(), &links, workers), links.count())
    }

    fn exchange(&self) -> Exchange<'_> {
        let Self { patches, hierarchy, bins, senders, settings, .. } = self;
        Exchange { bins, patches, hierarchy, senders, spreading: settings.spreading }
    }

    /// Makes the links of what moves.
    fn link(&mut self, workers: &dyn Workers) {
        self.of_moving = self.transfers(self.of_what_moves(), workers);
    }

    /// Pairs of elements that links from and to what moves are refined from.
    fn of_what_moves(&self) -> Vec<[usize; 2]> {
        match (self.still, self.patches.len()) {
            (0, 0) => Vec::new(),
            (0, _) => vec![[0, 0]],
            (still, all) if still == all => Vec::new(),
            _ => vec![[MOVING, MOVING], [STILL, MOVING]],
        }
    }
}

/// Elements of what stands and of what moves. The root is in neither where there is both.
fn parts(hierarchy: &Hierarchy, still: usize, patches: usize) -> [Vec<u32>; 2] {
    let all = 0..hierarchy.elements.len() as u32;
    match still {
        0 => [Vec::new(), all.collect()],
        still if still == patches => [all.collect(), Vec::new()],
        _ => {
            let mut moves = vec![false; hierarchy.elements.len()];
            for (i, element) in hierarchy.elements.iter().enumerate() {
                moves[i] = i == MOVING || element.parent != NONE && moves[element.parent as usize];
            }
            let (moving, still) = all.skip(1).partition(|i| moves[*i as usize]);
            [still, moving]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Linking, Serial};
    use super::*;
    use crate::random::Stream;
    use glam::Vec3;

    /// Patches of a ball that face inwards, and of a small one in it that face outwards, at a place.
    fn balls(at: Vec3) -> (Vec<Patch>, usize) {
        let mut stream = Stream::new(1, 13);
        let albedo = Vec3::splat(0.5);
        let mut out: Vec<Patch> = (0..400)
            .map(|_| stream.sphere())
            .map(|way| Patch::around(way, -way, 12.0 / 400.0, albedo))
            .collect();
        let still = out.len();
        out.extend(
            (0..60)
                .map(|_| stream.sphere())
                .map(|way| Patch::around(at + 0.2 * way, way, 0.5 / 60.0, albedo)),
        );
        (out, still)
    }

    fn settings() -> SolverSettings {
        SolverSettings { bins: 64, ..SolverSettings::default() }
    }

    /// Irradiance where the lower half of the large ball is lit.
    fn light(elements: &MovingElements) -> Vec<Vec3> {
        let lit = |patch: &Patch| if patch.normal.y > 0.0 { Vec3::ONE } else { Vec3::ZERO };
        let direct: Vec<Vec3> = elements.patches().iter().map(lit).collect();
        let solver = elements.solver();
        solver.solve(&solver.even_light(direct), &settings(), &Serial, &mut ()).0
    }

    #[test]
    fn lobes_that_follow_are_those_of_metals_made_there() {
        let metals = |at: Vec3| {
            let (mut patches, still) = balls(at);
            patches.iter_mut().step_by(7).for_each(|patch| patch.roughness = Some(0.4));
            (patches, still)
        };
        let (patches, still) = metals(Vec3::ZERO);
        let mut turned = patches.clone();
        turned[still..].iter_mut().for_each(|patch| patch.normal = -patch.normal);
        let mut followed = MovingElements::new(patches, still, settings(), &Serial);
        followed.follow(&turned[still..], &Serial);
        let anew = MovingElements::new(turned, still, settings(), &Serial);
        assert_eq!(followed.solver().lobes, anew.solver().lobes);
        assert!(anew.solver().lobes.patches.len() > 60);
    }

    #[test]
    fn links_that_follow_are_those_of_elements_made_there() {
        let (patches, still) = balls(Vec3::ZERO);
        let mut followed = MovingElements::new(patches.clone(), still, settings(), &Serial);
        let before = light(&followed);
        let (there, _) = balls(Vec3::new(0.3, -0.4, 0.1));
        followed.follow(&there[still..], &Serial);
        let mut slowly = MovingElements::new(patches, still, settings(), &Serial);
        slowly.begin_to_follow(&there[still..]);
        let pieces = 1 + (0..).take_while(|_| !slowly.advance(100)).count();
        assert!(pieces > 10 && !slowly.is_following() && slowly.of_moving == followed.of_moving);
        let anew = MovingElements::new(there, still, settings(), &Serial);
        let (found, expected) = (light(&followed), light(&anew));
        let solver = anew.solver();
        let [same, apart] = [&found, &before].map(|light| solver.difference(light, &expected));
        assert!(same < 1e-3 && apart > 0.02, "{same}, {apart}");
        assert_eq!(followed.solver().links, solver.links);
    }

    #[test]
    fn links_made_piece_by_piece_are_those_made_at_once() {
        let (patches, still) = balls(Vec3::new(0.2, 0.0, 0.0));
        for still in [0, still, patches.len()] {
            let whole = MovingElements::new(patches.clone(), still, settings(), &Serial);
            for work in [300, 7_000, usize::MAX] {
                let mut linking = Linking::new(patches.clone(), still, settings());
                let mut pieces = 0;
                let (elements, tables) = loop {
                    pieces += 1;
                    match linking.advance(work) {
                        Ok(done) => break done,
                        Err(left) => linking = left,
                    }
                };
                assert!(
                    elements.between_still == whole.between_still && elements.of_moving == whole.of_moving
                );
                assert!(tables == whole.still_tables());
                assert!(work > 300 || still == 0 || pieces > 10, "{pieces}");
            }
        }
    }

    #[test]
    fn parts_make_no_difference_to_links_between_patches() {
        let (patches, still) = balls(Vec3::new(0.2, 0.0, 0.0));
        // Clusters, which differ, have no links.
        let narrow = SolverSettings { width: 0.0, ..settings() };
        let parted = MovingElements::new(patches.clone(), still, narrow, &Serial);
        let whole = MovingElements::new(patches.clone(), patches.len(), narrow, &Serial);
        let all = MovingElements::new(patches, 0, narrow, &Serial);
        let links = [&parted, &whole, &all].map(|elements| elements.solver().links);
        assert!(links[0] == links[1] && links[1] == links[2], "{links:?}");
        let solver = whole.solver();
        let expected = light(&whole);
        let off = [&parted, &all].map(|elements| solver.difference(&light(elements), &expected));
        assert!(off.iter().all(|off| *off < 1e-4), "{off:?}");
    }
}
