//! Functions after a motion: where surfaces stand around a point otherwise than in the bake, its clip planes and samples of
//! direct light are worked out anew, and so are the parents and children that the planes part.
//!
//! The laws are the baker's ([`clip_planes`], [`samples`]); a closed door is a wall. The table that finds functions knows no
//! planes, and stays.

use super::accelerator::{Accelerator, PlacedModels};
use super::placed_surfaces::PlacedSurfaces;
use super::touched::touched;
use crate::baked::BakedScene;
use crate::basis::{Functions, MostEntries, Relations};
use crate::clip_planes::clip_planes;
use crate::footprint::samples;
use crate::motion::Motions;
use crate::random::mix;
use crate::rbn::bulk::{Cut, MAX_ALL_CUTS, MAX_CUTS, Point};

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
    /// Points that have been looked at anew, ascending.
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
    ///
    /// Where there are more planes than [`most_cuts`], the points beyond keep the file's, and so does the scene keep its
    /// relations where there are more than [`most_entries`].
    pub fn new(
        scene: &BakedScene,
        accelerator: &Accelerator,
        placed: &PlacedModels,
        motions: &Motions,
    ) -> Self {
        let surfaces = PlacedSurfaces::new(scene, accelerator, placed);
        let (mut points, mut cuts) = (scene.points.clone(), scene.cuts.clone());
        let renewed = touched(scene, accelerator, motions);
        let most = most_cuts(scene);
        let mut changed = Vec::new();
        for i in &renewed {
            let (index, seed) = (*i as usize, mix(u64::from(*i)) as u32);
            let supported = surfaces.supported(&scene.moved_point(index, motions));
            let mut own = clip_planes(&surfaces, &supported, seed);
            let mask = samples(&surfaces, &supported, &own, seed);
            let motion = motions.of(scene.group_of(index));
            if motion.is_moved() {
                for cut in &mut own {
                    let towards = glam::Vec3A::from(cut.towards);
                    cut.towards = (motion.rest_from_local.matrix3 * towards).to_array();
                }
            }
            if own == scene.cuts_of(index) {
                let range = scene.points[index].cuts();
                points[index].cuts = Point::pack_cuts(range.start, range.len(), mask);
            } else if cuts.len() + own.len() <= most {
                points[index].cuts = Point::pack_cuts(cuts.len(), own.len(), mask);
                cuts.extend(own);
                changed.push(*i);
            }
        }
        let relations = if changed.is_empty() {
            None
        } else {
            let levels = &scene.meta.levels;
            let functions = Functions { points: &points, cuts: &cuts, levels, groups: &scene.point_groups };
            let ways = (scene.meta.direct_levels as usize, scene.parent_weights);
            scene.relations.renewed(&functions, &changed, ways, most_entries(scene))
        };
        Self { renewed, points, cuts, relations }
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
