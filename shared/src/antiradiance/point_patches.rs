//! Patches of a file's points: each point of a level stands for the surface around it.
//!
//! A level of the basis covers all surfaces by itself. What moves is of another level than what stands, so that it has enough
//! patches however small it is beside the room.

use super::patches::Patch;
use crate::baked::BakedScene;
use glam::{IVec3, Vec3};
use std::collections::HashMap;
use std::ops::Range;

/// A triangle of a scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneTriangle {
    /// Corners, local space.
    pub corners: [Vec3; 3],
    /// Whether it has two sides.
    pub is_two_sided: bool,
    /// Roughness of a metal.
    pub roughness: Option<f32>,
}

/// Calls with every triangle.
pub type EachTriangle<'a> = dyn Fn(&mut dyn FnMut(SceneTriangle)) + 'a;

/// Position and normal of a point, local space.
pub type PointPlaces<'a> = dyn Fn(usize) -> [Vec3; 2] + 'a;

/// Least cosine of normals of a point and of a surface that it stands for.
const SAME: f32 = 0.5;
/// Pieces of surface that are looked at for each patch.
const PIECES: f32 = 16.0;
/// Side of a cell of the grid, in sides of a square of a patch's mean area.
const CELL: f32 = 2.0;
/// Least area of a patch, as a share of the mean.
const LEAST: f32 = 0.05;

/// Points with a patch each: static ones first, then moving ones.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PointPatches {
    /// Number of the point of each patch.
    pub points: Vec<u32>,
    /// Number of patches that stand.
    pub still: usize,
    surfaces: Vec<Surface>,
    albedo: Vec<Vec3>,
}

/// The surface that a point stands for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Surface {
    /// Square scene units.
    area: f32,
    /// Roughness, if most of it is metal.
    roughness: Option<f32>,
}

impl PointPatches {
    /// Chooses the finest levels with at most `most` points that stand, and that move. `at` has where the points are on the
    /// triangles.
    pub fn new(
        scene: &BakedScene,
        moves: &dyn Fn(usize) -> bool,
        most: [usize; 2],
        (each_triangle, at): (&EachTriangle<'_>, &PointPlaces<'_>),
    ) -> Self {
        let levels = || (0..scene.meta.levels.len()).map(|level| scene.level(level));
        let chosen = |kind: bool, most: usize| {
            let own = |level: Range<usize>| level.filter(|i| moves(*i) == kind).map(|i| i as u32);
            let fitting = levels().rev().find(|level| own(level.clone()).count() <= most);
            fitting.or_else(|| levels().next()).map_or(Vec::new(), |level| own(level).collect())
        };
        let mut points = chosen(false, most[0]);
        let still = points.len();
        points.extend(chosen(true, most[1]));
        let albedo = points.iter().map(|i| scene.albedo(*i as usize)).collect();
        let places: Vec<[Vec3; 2]> = points.iter().map(|i| at(*i as usize)).collect();
        let surfaces = surfaces(&places, each_triangle);
        Self { points, still, surfaces, albedo }
    }

    /// The patches, where `at` has the position and the normal of a point, local space.
    pub fn patches(&self, at: &PointPlaces<'_>) -> Vec<Patch> {
        self.of(0..self.points.len(), at)
    }

    /// Those of [`Self::patches`] that move.
    pub fn moving(&self, at: &PointPlaces<'_>) -> Vec<Patch> {
        self.of(self.still..self.points.len(), at)
    }

    fn of(&self, numbers: Range<usize>, at: &PointPlaces<'_>) -> Vec<Patch> {
        let patch = |i: usize| {
            let [position, normal] = at(self.points[i] as usize);
            let Surface { area, roughness } = self.surfaces[i];
            Patch { roughness, ..Patch::around(position, normal, area, self.albedo[i]) }
        };
        numbers.map(patch).collect()
    }
}

/// What points at `places` stand for: the pieces of surface nearest to each that face the same way.
fn surfaces(places: &[[Vec3; 2]], each_triangle: &EachTriangle<'_>) -> Vec<Surface> {
    let size = |[a, b, c]: [Vec3; 3]| 0.5 * (b - a).cross(c - a).length();
    let mut whole = 0.0;
    each_triangle(&mut |own| whole += size(own.corners) * if own.is_two_sided { 2.0 } else { 1.0 });
    let mean = whole / places.len().max(1) as f32;
    if mean <= 0.0 {
        return vec![Surface::default(); places.len()];
    }
    let side = CELL * mean.sqrt();
    let cell = |place: Vec3| (place / side).floor().as_ivec3();
    let mut grid: HashMap<IVec3, Vec<u32>> = HashMap::new();
    for (number, [position, _]) in (0..).zip(places) {
        grid.entry(cell(*position)).or_default().push(number);
    }
    let nearest = |place: Vec3, normal: Vec3| {
        let around = (0..27).map(|i| cell(place) + IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
        let near = around.filter_map(|cell| grid.get(&cell)).flatten().copied();
        let facing = near.filter(|number| places[*number as usize][1].dot(normal) > SAME);
        let distance = |number: &u32| places[*number as usize][0].distance_squared(place);
        facing.min_by(|a, b| distance(a).total_cmp(&distance(b)))
    };
    // Area, that of metals, and their mean roughness times it.
    let mut out = vec![[0.0f32; 3]; places.len()];
    let mut found = 0.0;
    let mut open = Vec::new();
    each_triangle(&mut |SceneTriangle { corners, is_two_sided, roughness }| {
        let [a, b, c] = corners;
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { return };
        open.push(Patch { corners, normal, ..Patch::default() });
        while let Some(piece) = open.pop() {
            let area = piece.area();
            if area > mean / PIECES {
                open.extend(piece.halves());
                continue;
            }
            for normal in [normal, -normal].into_iter().take(if is_two_sided { 2 } else { 1 }) {
                if let Some(number) = nearest(piece.position(), normal) {
                    let out = &mut out[number as usize];
                    out[0] += area;
                    if let Some(roughness) = roughness {
                        out[1] += area;
                        out[2] += roughness * area;
                    }
                    found += area;
                }
            }
        }
    });
    // Pieces without a point are with the others.
    let more = whole / found.max(f32::MIN_POSITIVE);
    let surface = |[area, metal, rough]: &[f32; 3]| Surface {
        area: (more * area).max(LEAST * mean),
        roughness: (metal + metal > *area).then(|| rough / metal),
    };
    out.iter().map(surface).collect()
}
