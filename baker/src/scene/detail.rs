//! Main part of a scene, with nearly all of the detail: the house on the plain, the room beside a stray.
//!
//! Single-precision numbers are most exact near zero. Therefore the origin of local space is in the main part, and the
//! main part's size bounds the offset of ray origins from surfaces. A cube is the main part if it contains the majority
//! of the occupied cells of a grid with an eighth of the cube's side as cell size. The weight of a cell is its number
//! of vertices up to a small limit, so that a dense mesh counts by its extent, and a plain of any size counts by its
//! corners.

use super::steps::least_step;
use glam::{DVec3, IVec3, Vec3};
use std::collections::HashMap;

/// Maximum number of vertices examined; larger vertex sets are subsampled at a regular stride.
const LOOKED_AT: usize = 30_000;
/// Minimum width of the scene over the width of the main part; below this ratio a main part gains no precision.
const WIDER: f64 = 8.0;
/// Cells along a side of a part.
const CELLS: f64 = 8.0;
/// Maximum number of vertices counted per cell.
const COUNTED: usize = 8;
/// Minimum share of the counted vertices inside the part.
const MOST: f64 = 0.6;
/// Minimum side of a part over the side of the whole; smaller parts are lost to rounding at any position.
const LEAST: f64 = 1e-8;

/// Offset of ray origins from surfaces, over the main part's diagonal. In the main part local coordinates are at most
/// half the diagonal, so an f32 is off by 3e-8 of the diagonal and a plane distance over the whole scene by a few times
/// as much: a tenfold margin is safe, and 0.1 mm in a 30 m hall.
const EPSILON: f32 = 3e-6;
/// Minimum offset of ray origins over the greatest absolute local coordinate; applies outside the main part. Twice
/// [`EPSILON`], because the corners of a scene that is entirely main part are half a diagonal away: about equal offsets
/// there.
const EPSILON_AWAY: f32 = 6e-6;

/// Precision of positions.
#[derive(Clone, Copy, Debug)]
pub struct Exactness {
    /// Offset of ray origins in the main part, scene units.
    pub near: f32,
}

impl Exactness {
    /// Precision in a scene with this main part and these bounds, local space.
    pub fn new(main: (Vec3, Vec3), bounds: (Vec3, Vec3)) -> Self {
        // Rounding moves points by less than this.
        let rounded = 2.0 * least_step(bounds.0, bounds.1);
        Self { near: (EPSILON * (main.1 - main.0).length()).max(rounded) }
    }

    /// Safe offset of ray origins from surfaces at `position`, scene units.
    #[inline]
    pub fn at(self, position: Vec3) -> f32 {
        self.near.max(EPSILON_AWAY * position.abs().max_element())
    }
}

/// Least and greatest corner of the main part of these vertices; `None` unless the bounds of all vertices are much
/// wider (`WIDER`).
pub fn main_part(vertices: &[DVec3]) -> Option<[DVec3; 2]> {
    let mut some: Vec<DVec3> =
        vertices.iter().step_by(vertices.len().div_ceil(LOOKED_AT).max(1)).copied().collect();
    some.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)).then(a.z.total_cmp(&b.z)));
    some.dedup();
    let bounds = |some: &[DVec3]| {
        some.iter().map(|p| [*p, *p]).reduce(|[low, high], [p, _]| [low.min(p), high.max(p)])
    };
    let [low, high] = bounds(vertices)?;
    let whole = (high - low).max_element();
    let mut side = whole / WIDER;
    let mut found = None;
    while side > LEAST * whole && side > 0.0 {
        found = within(&some, low, side).or(found);
        side *= 0.5;
    }
    let (middle, side) = found?;
    let near = |p: &&DVec3| (**p - middle).abs().max_element() <= 0.5 * side;
    let part: Vec<DVec3> = vertices.iter().filter(near).copied().collect();
    bounds(&part)
}

/// Computes [`main_part`] in local space.
pub fn part_of(vertices: impl Iterator<Item = Vec3>) -> Option<(Vec3, Vec3)> {
    let [low, high] = main_part(&vertices.map(|p| p.as_dvec3()).collect::<Vec<_>>())?;
    Some((low.as_vec3(), high.as_vec3()))
}

/// Centre and side of a cube with the majority of the counted vertices, from cells of size `side / CELLS`; `None` if no
/// cube of this side has a majority. The caller has removed duplicate vertices.
fn within(vertices: &[DVec3], low: DVec3, side: f64) -> Option<(DVec3, f64)> {
    let cell = side / CELLS;
    let mut counts: HashMap<IVec3, usize> = HashMap::new();
    let mut cells: Vec<IVec3> = Vec::new();
    for vertex in vertices {
        // Rounding puts the least and greatest vertex inside cells, not on cell borders.
        let cell = ((vertex - low) / cell).round().as_ivec3();
        let count = counts.entry(cell).or_default();
        *count += 1;
        if *count <= COUNTED {
            cells.push(cell);
        }
    }
    let mut middle = IVec3::ZERO;
    for axis in 0..3 {
        let mut along: Vec<i32> = cells.iter().map(|cell| cell[axis]).collect();
        let half = along.len() / 2;
        middle[axis] = *along.select_nth_unstable(half).1;
    }
    let reach = (0.5 * CELLS) as i32;
    let near = cells.iter().filter(|cell| (**cell - middle).abs().max_element() <= reach).count();
    let is_most = near as f64 >= MOST * cells.len() as f64;
    // Half a cell of margin on each side of the counted cells.
    is_most.then(|| (low + middle.as_dvec3() * cell, side + 2.0 * cell))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Corners of a box of this size around `middle`.
    fn block(middle: DVec3, size: f64) -> Vec<DVec3> {
        let sign = |i: usize, axis: usize| if i >> axis & 1 == 0 { -0.5 } else { 0.5 };
        (0..8).map(|i| middle + size * DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2))).collect()
    }

    fn house(at: DVec3) -> Vec<DVec3> {
        let wall =
            |k: usize| block(at + DVec3::new(k as f64 - 2.0, 1.0, 0.5 * k as f64), 1.0 + 0.3 * k as f64);
        (0..5).flat_map(wall).collect()
    }

    #[test]
    fn a_house_is_found_on_any_plain_wherever_it_stands() {
        for (size, at) in [(300.0, DVec3::ZERO), (1e4, DVec3::new(2000.0, 5.0, -300.0)), (1e6, DVec3::ONE)] {
            let mut vertices = house(at);
            for (x, z) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                vertices.push(0.5 * size * DVec3::new(x, 0.0, z));
            }
            let [low, high] = main_part(&vertices).unwrap();
            assert!((high - low).max_element() < 12.0, "{size}: {low} {high}");
            assert!(low.distance(at) < 12.0 && high.distance(at) < 12.0, "{size}: {low} {high}");
        }
    }

    #[test]
    fn a_room_is_found_beside_a_stray_and_what_is_everywhere_is_no_part() {
        let room = [block(DVec3::ZERO, 4.0), block(DVec3::ONE, 1.0)].concat();
        let stray = block(DVec3::new(8e4, 0.0, 3.0), 1.0);
        let [low, high] = main_part(&[room.clone(), stray].concat()).unwrap();
        assert_eq!((low, high), (DVec3::splat(-2.0), DVec3::splat(2.0)));
        assert_eq!(main_part(&room), None);
        // A town of a square kilometre; a dense statue adds no main part.
        let places = (0..400).map(|i| DVec3::new((i % 20) as f64, 0.0, (i / 20) as f64) * 50.0);
        let mut town: Vec<DVec3> = places.flat_map(|at| block(at, 10.0)).collect();
        assert_eq!(main_part(&town), None);
        let turn = |i: u32| DVec3::new((i as f64).sin(), (0.7 * i as f64).sin(), (1.3 * i as f64).sin());
        town.extend((0..10_000).map(|i| DVec3::new(500.0, 2.0, 510.0) + turn(i)));
        assert_eq!(main_part(&town), None);
        assert_eq!(main_part(&[]), None);
    }
}
