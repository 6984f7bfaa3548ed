//! Patches of a file's points: each point of a level stands for the surface around it.
//!
//! A level of the basis covers all surfaces by itself. What moves is of another level than what stands, so that it has enough
//! patches however small it is beside the room.

use super::patches::Patch;
use crate::baked::BakedScene;
use crate::elementary::Elementary;
use crate::footprint::tangents;
use glam::{IVec3, Vec2, Vec3};
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
    /// Whether it moves or deforms: it is of points that do.
    pub moves: bool,
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
/// Greatest distance of a piece that stands from the plane of its point, as a share of that from the point.
const OFF: f32 = 0.3;

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
    /// Middle from the point, and axes of the same moments, in the plane of [`tangents`].
    middle: Vec2,
    axes: [Vec2; 2],
    /// Roughness, if most of it is metal.
    roughness: Option<f32>,
}

impl Surface {
    /// A triangle with this surface's area and, but for a factor, its moments.
    fn patch(&self, position: Vec3, normal: Vec3) -> Patch {
        let (u, v) = tangents(normal);
        let in_space = |place: Vec2| place.x * u + place.y * v;
        let middle = position + in_space(self.middle);
        Patch { normal, ..Patch::along(self.axes.map(in_space), middle, self.area) }
    }
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
        let surfaces = surfaces(&places, still, each_triangle);
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
            let surface = &self.surfaces[i];
            let patch = match i < self.still {
                true => surface.patch(position, normal),
                // The tangent plane of what moves turns in itself.
                false => Patch::around(position, normal, surface.area, Vec3::ZERO),
            };
            Patch { albedo: self.albedo[i], roughness: surface.roughness, ..patch }
        };
        numbers.map(patch).collect()
    }
}

/// Sums over the pieces of surface of a point.
#[derive(Clone, Copy, Default)]
struct Moments {
    area: f32,
    /// Areas times places in the tangent plane, and times their products: uu, uv, vv.
    first: Vec2,
    second: Vec3,
    /// Area of metals, and that times their roughness.
    metal: f32,
    rough: f32,
}

impl Moments {
    fn add(&mut self, area: f32, place: Vec2, roughness: Option<f32>) {
        self.area += area;
        self.first += area * place;
        self.second += area * Vec3::new(place.x * place.x, place.x * place.y, place.y * place.y);
        if let Some(roughness) = roughness {
            self.metal += area;
            self.rough += roughness * area;
        }
    }

    fn surface(&self) -> Surface {
        let Self { area, first, second, metal, rough } = *self;
        if area <= 0.0 {
            return Surface::default();
        }
        let (middle, second) = (first / area, second / area);
        let [uu, uv, vv] =
            (second - Vec3::new(middle.x * middle.x, middle.x * middle.y, middle.y * middle.y)).to_array();
        // Eigenvectors of the covariance: half the angle of (uu − vv, 2 uv).
        let (mean, difference) = (0.5 * (uu + vv), 0.5 * (uu - vv));
        let spread = (difference * difference + uv * uv).sqrt();
        let (sine, cosine) = (0.5 * uv.arc_tangent2(difference)).sine_cosine();
        let lengths = [mean + spread, mean - spread].map(|variance| variance.max(0.0).sqrt());
        // Not narrower than a tenth of its length: pieces are points here.
        let narrowest = lengths[1].max(0.1 * lengths[0]);
        let roughness = (metal + metal > area).then(|| rough / metal);
        Surface {
            area,
            middle,
            axes: [lengths[0] * Vec2::new(cosine, sine), narrowest * Vec2::new(-sine, cosine)],
            roughness,
        }
    }
}

/// Surfaces of points at `places`, of which the first `still` stand. A point has the pieces of triangles nearest to it, in its
/// plane and with its normal. Pieces off the plane of the nearest point, as slender legs of chairs, are left out.
fn surfaces(places: &[[Vec3; 2]], still: usize, each_triangle: &EachTriangle<'_>) -> Vec<Surface> {
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
    let nearest = |place: Vec3, normal: Vec3, moves: bool| {
        let around = (0..27).map(|i| cell(place) + IVec3::new(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1));
        let near = around.filter_map(|cell| grid.get(&cell)).flatten().copied();
        let facing = near.filter(|number| {
            places[*number as usize][1].dot(normal) > SAME && (*number as usize >= still) == moves
        });
        let distance = |number: &u32| places[*number as usize][0].distance_squared(place);
        let number = facing.min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
        let [position, own] = places[number as usize];
        let way = place - position;
        (moves || way.dot(own).abs() <= OFF * way.length()).then_some(number)
    };
    let mut out = vec![Moments::default(); places.len()];
    let mut open = Vec::new();
    each_triangle(&mut |SceneTriangle { corners, is_two_sided, roughness, moves }| {
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
                if let Some(number) = nearest(piece.position(), normal, moves) {
                    let [position, own] = places[number as usize];
                    let (u, v) = tangents(own);
                    let way = piece.position() - position;
                    out[number as usize].add(area, Vec2::new(way.dot(u), way.dot(v)), roughness);
                }
            }
        }
    });
    out.iter().map(Moments::surface).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_patch_has_the_area_the_middle_and_the_proportions_of_its_surface() {
        let normal = Vec3::new(0.3, 0.8, -0.5).normalize();
        let (u, v) = tangents(normal);
        // A board of 1.2 by 0.2, turned, beside its point.
        for turn in [0.0f32, 0.7, 2.0] {
            let (along, across) = (Vec2::from_angle(turn), Vec2::from_angle(turn).perp());
            let middle = Vec2::new(0.4, -0.1);
            let mut moments = Moments::default();
            for (i, j) in (0..60).flat_map(|i| (0..10).map(move |j| (i, j))) {
                let place = [(i as f32 + 0.5) / 60.0 - 0.5, (j as f32 + 0.5) / 10.0 - 0.5];
                let place = middle + 1.2 * place[0] * along + 0.2 * place[1] * across;
                moments.add(1.2 * 0.2 / 600.0, place, (i < 40).then_some(0.3));
            }
            let surface = moments.surface();
            let patch = surface.patch(Vec3::ONE, normal);
            assert!((patch.area() - 0.24).abs() < 1e-4, "{}", patch.area());
            assert!(patch.position().distance(Vec3::ONE + middle.x * u + middle.y * v) < 1e-4);
            let way = along.x * u + along.y * v;
            let reach = |way: Vec3| {
                let at = patch.corners.map(|corner| (corner - patch.position()).dot(way).abs());
                at.into_iter().fold(0.0, f32::max)
            };
            let ratio = reach(way) / reach(normal.cross(way));
            assert!((4.0..9.0).contains(&ratio), "{ratio} at {turn}");
            assert!(surface.roughness.is_some_and(|roughness| (roughness - 0.3).abs() < 1e-5));
        }
    }
}
