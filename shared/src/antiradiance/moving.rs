//! Elements of which some move: links between what stands are made once, those of what moves after each motion (antiradiance
//! paper, section 3.3).
//!
//! What moves has a subtree of its own, whose clusters keep their children: elements keep their numbers, and light by element and
//! bin goes on from where it was.

use super::bins::Bins;
use super::hierarchy::{Hierarchy, NONE};
use super::links::Links;
use super::lobe::Lobes;
use super::patches::Patch;
use super::solve::{AntiradianceSolver, SolverSettings};
use super::transfers::{Exchange, Transfers};
use super::workers::Workers;

/// Roots of the static and of the moving subtree in a [`Hierarchy::parted`].
const STILL: usize = 1;
const MOVING: usize = 2;

/// Elements and links of a scene whose last patches move.
pub struct MovingElements {
    patches: Vec<Patch>,
    /// Number of patches that stand: the first ones.
    still: usize,
    settings: SolverSettings,
    bins: Bins,
    hierarchy: Hierarchy,
    /// By element, whether it moves.
    moves: Vec<bool>,
    /// Transfers between elements that stand, and the number of their links.
    between_still: (Transfers, usize),
    /// All transfers, and the number of all links.
    all: (Transfers, usize),
    /// By patch: see [`normalisation`](super::cosines::normalisation).
    normalisations: Vec<f32>,
    lobes: Lobes,
}

impl MovingElements {
    /// Makes hierarchy, links and form factors of patches of which the first `still` stand.
    pub fn new(patches: Vec<Patch>, still: usize, settings: SolverSettings, workers: &dyn Workers) -> Self {
        let hierarchy = Hierarchy::parted(&patches, still);
        let is_parted = still > 0 && still < patches.len();
        let mut moves = vec![still == 0; hierarchy.elements.len()];
        for (i, element) in hierarchy.elements.iter().enumerate().filter(|_| is_parted) {
            moves[i] = i == MOVING || element.parent != NONE && moves[element.parent as usize];
        }
        let mut out = Self {
            patches,
            still,
            settings,
            bins: Bins::new(settings.bins),
            hierarchy,
            moves,
            between_still: Default::default(),
            all: Default::default(),
            normalisations: Vec::new(),
            lobes: Lobes::default(),
        };
        let open = match (is_parted, still) {
            (true, _) => vec![[STILL, STILL]],
            (false, 0) => Vec::new(),
            (false, _) => vec![[0, 0]],
        };
        out.between_still = out.transfers(open, workers);
        out.link(workers);
        out.lobes = Lobes::new(&out.patches, &out.bins, &out.normalisations);
        out
    }

    /// Puts the patches that move elsewhere, in their order, and makes their links anew.
    pub fn follow(&mut self, moved: &[Patch], workers: &dyn Workers) {
        self.patches[self.still..].copy_from_slice(moved);
        self.hierarchy.follow(&self.patches, &self.moves);
        self.link(workers);
        self.lobes.follow(&self.patches, &self.bins, &self.normalisations, self.still);
    }

    /// Patches: static ones first, then moving ones.
    pub fn patches(&self) -> &[Patch] {
        &self.patches
    }

    /// A solver of the present elements and links.
    pub fn solver(&self) -> AntiradianceSolver<'_> {
        AntiradianceSolver::linked(
            &self.patches,
            (self.hierarchy.clone(), self.bins.clone()),
            self.all.clone(),
            (self.normalisations.clone(), self.lobes.clone()),
        )
    }

    /// Transfers of the links between pairs of elements, and the number of links.
    fn transfers(&mut self, open: Vec<[usize; 2]>, workers: &dyn Workers) -> (Transfers, usize) {
        let Self { patches, hierarchy, bins, settings, .. } = &*self;
        let exchange = Exchange::new(bins, patches, hierarchy, settings.spreading);
        let links = Links::between(patches, hierarchy, bins, settings.width, open);
        let transfers = Transfers::new(&exchange, &links, workers);
        self.normalisations = exchange.normalisations;
        (transfers, links.count())
    }

    /// Adds the links of what moves to those of what stands.
    fn link(&mut self, workers: &dyn Workers) {
        let open = match (self.still, self.patches.len()) {
            (0, 0) => Vec::new(),
            (0, _) => vec![[0, 0]],
            (still, all) if still == all => Vec::new(),
            _ => vec![[MOVING, MOVING], [STILL, MOVING]],
        };
        let (moving, links) = self.transfers(open, workers);
        let (still, still_links) = &self.between_still;
        self.all = (still.and(&moving), still_links + links);
    }
}

#[cfg(test)]
mod tests {
    use super::super::Serial;
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
        let mut followed = MovingElements::new(patches, still, settings(), &Serial);
        let before = light(&followed);
        let (there, _) = balls(Vec3::new(0.3, -0.4, 0.1));
        followed.follow(&there[still..], &Serial);
        let anew = MovingElements::new(there, still, settings(), &Serial);
        let (found, expected) = (light(&followed), light(&anew));
        let solver = anew.solver();
        let [same, apart] = [&found, &before].map(|light| solver.difference(light, &expected));
        assert!(same < 1e-3 && apart > 0.02, "{same}, {apart}");
        assert_eq!(followed.solver().links, solver.links);
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
