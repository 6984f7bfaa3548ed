//! Functions after a motion: where surfaces stand around a point otherwise than in the bake, its clip planes and samples of
//! direct light are worked out anew, and so are the parents and children that the planes part.
//!
//! The laws are the baker's ([`clip_planes`], [`samples`]); a closed door is a wall. The table that finds functions knows no
//! planes, and stays.

use super::accelerator::{Accelerator, PlacedModels};
use super::placed_surfaces::PlacedSurfaces;
use super::touched::SupportBoxes;
use crate::baked::BakedScene;
use crate::basis::{Functions, MostEntries, Relations};
use crate::clip_planes::clip_planes;
use crate::footprint::samples;
use crate::motion::Motions;
use crate::random::mix;
use crate::rbn::bulk::{Cut, MAX_ALL_CUTS, MAX_CUTS, Point};
use glam::Vec3A;
use std::collections::BTreeMap;

/// Greatest number of planes of a scene whose nodes move: those of the file, and new ones of every point, as far as a point
/// can name them.
pub fn most_cuts(scene: &BakedScene) -> usize {
    (scene.cuts.len() + MAX_CUTS * scene.points.len()).min(MAX_ALL_CUTS)
}

/// Greatest numbers of parents and of children of a scene whose nodes move: half as many again as the file has.
pub fn most_entries(scene: &BakedScene) -> MostEntries {
    let most = |entries: usize| entries + entries / 2 + 4096;
    MostEntries {
        push: most(scene.relations.push_entries.len()),
        pull: most(scene.relations.pull_entries.len()),
    }
}

/// Functions of a scene whose groups have moved, in the places that the file has them in.
#[derive(Clone, Debug, Default)]
pub struct ClippedFunctions {
    /// Points that have been looked at anew since the bake, ascending.
    pub renewed: Vec<u32>,
    /// All points, with their ranges of clip planes and their samples.
    pub points: Vec<Point>,
    /// The file's planes, and the new ones after them.
    pub cuts: Vec<Cut>,
    /// Parents and children; `None` where they are the file's.
    pub relations: Option<Relations>,
}

impl ClippedFunctions {
    /// Returns the functions of a scene whose groups are where `motions` have them; `placed` are its models there.
    pub fn new(
        scene: &BakedScene,
        accelerator: &Accelerator,
        placed: &PlacedModels,
        motions: &Motions,
    ) -> Self {
        Clipping::new(scene).follow(scene, accelerator, placed, motions)
    }

    /// Returns what of a scene its light is computed from, with these functions: without triangles, textures and links.
    pub fn of(self, scene: &BakedScene) -> BakedScene {
        BakedScene {
            meta: scene.meta.clone(),
            instances: scene.instances.clone(),
            copies: scene.copies.clone(),
            points: self.points,
            cuts: self.cuts,
            openness: scene.openness.clone(),
            parent_weights: scene.parent_weights,
            relations: self.relations.unwrap_or_else(|| scene.relations.clone()),
            sources: scene.sources.clone(),
            source_links: scene.source_links.clone(),
            groups: scene.groups.clone(),
            point_groups: scene.point_groups.clone(),
            reflectance: scene.reflectance.clone(),
            ..BakedScene::default()
        }
    }
}

/// What ends a function, in the directions that the file has.
#[derive(Clone, Debug, Default, PartialEq)]
struct Clip {
    cuts: Vec<Cut>,
    /// Samples of direct light, one bit per sample.
    samples: u8,
}

/// Follows motions one after another: what a motion does not touch is known from the one before it. The result depends on
/// where groups are alone, and not on the way there.
#[derive(Clone, Debug)]
pub struct Clipping {
    boxes: SupportBoxes,
    /// Where groups are.
    at: Motions,
    /// What ends the functions that something has touched so far; right where a group's surfaces stand now.
    known: BTreeMap<u32, Clip>,
}

impl Clipping {
    /// Begins with a scene whose groups are where the file has them.
    pub fn new(scene: &BakedScene) -> Self {
        Self { boxes: SupportBoxes::new(scene), at: Motions::default(), known: BTreeMap::new() }
    }

    /// Returns the functions of the scene with its groups where `motions` have them; `placed` are its models there.
    ///
    /// Where there are more planes than [`most_cuts`], the points beyond keep the file's, and so does the scene keep its
    /// relations where there are more than [`most_entries`].
    pub fn follow(
        &mut self,
        scene: &BakedScene,
        accelerator: &Accelerator,
        placed: &PlacedModels,
        motions: &Motions,
    ) -> ClippedFunctions {
        let surfaces = PlacedSurfaces::new(scene, accelerator, placed);
        let before = std::mem::replace(&mut self.at, motions.clone());
        // Planes of a group that moves are rounded in other directions, even where nothing touches them.
        let stays = |i: &u32| {
            let group = scene.group_of(*i as usize);
            before.of(group) == motions.of(group)
        };
        self.known.retain(|i, _| stays(i));
        for i in self.boxes.touched(scene, accelerator, [&before, motions]) {
            self.known.remove(&i);
        }
        let renewed = self.boxes.touched(scene, accelerator, [&Motions::default(), motions]);
        let (mut points, mut cuts) = (scene.points.clone(), scene.cuts.clone());
        let most = most_cuts(scene);
        let mut changed = Vec::new();
        for i in &renewed {
            let index = *i as usize;
            let clip = self.known.entry(*i).or_insert_with(|| clip(scene, &surfaces, motions, *i));
            let (own, range) = (&clip.cuts, scene.points[index].cuts());
            if own == scene.cuts_of(index) {
                points[index].cuts = Point::pack_cuts(range.start, range.len(), clip.samples);
            } else if cuts.len() + own.len() <= most {
                points[index].cuts = Point::pack_cuts(cuts.len(), own.len(), clip.samples);
                cuts.extend(own);
                changed.push(*i);
            }
        }
        let relations = if changed.is_empty() {
            None
        } else {
            let levels = &scene.meta.levels;
            let functions = |points, cuts| Functions { points, cuts, levels, groups: &scene.point_groups };
            let (before, now) = (functions(&scene.points, &scene.cuts), functions(&points, &cuts));
            let ways = (scene.meta.direct_levels as usize, scene.parent_weights);
            scene.relations.renewed([&before, &now], &changed, ways, most_entries(scene))
        };
        ClippedFunctions { renewed, points, cuts, relations }
    }
}

/// What ends a function of a scene whose groups have moved, by the laws of the bake.
fn clip(scene: &BakedScene, surfaces: &PlacedSurfaces<'_>, motions: &Motions, i: u32) -> Clip {
    let (index, seed) = (i as usize, mix(u64::from(i)) as u32);
    let supported = surfaces.supported(&scene.moved_point(index, motions));
    let mut cuts = clip_planes(surfaces, &supported, seed);
    let samples = samples(surfaces, &supported, &cuts, seed);
    let motion = motions.of(scene.group_of(index));
    if motion.is_moved() {
        for cut in &mut cuts {
            cut.towards = (motion.rest_from_local.matrix3 * Vec3A::from(cut.towards)).to_array();
        }
    }
    Clip { cuts, samples }
}
