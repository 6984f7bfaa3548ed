//! Lookup of functions that may cover a place: a hash grid per level, in a single array of words shared with the GPU.
//!
//! A pixel reads one bucket of its level and tests the functions in the bucket; lookup.wgsl of the viewer reads this
//! array. A bucket is that of a cell and a reconstruction group: many small objects may share a cell. An entry has the
//! function's group beside its number, as cells of several groups may share a bucket.

use super::Functions;
use crate::interpolation::MAX_POINTS;
use crate::kernel::{LEAST_WEIGHT, SQUASH, weight};
use crate::rbn::bulk::{Cut, Point};
use bytemuck::{Pod, Zeroable};
use glam::{IVec3, Vec3};

/// Header words per level: reciprocal of the cell size (f32), first bucket, number of buckets minus one.
pub const LEVEL_WORDS: usize = 3;
/// Width of a cell over the largest support radius of its level.
const CELL: f32 = 0.6;
/// Enlargement of supports in the grid, so that rounding at a cell's rim is harmless.
const MARGIN: f32 = 1.001;

/// A function in a bucket: bits 0 to 21 its number over all levels, 22 to 31 its reconstruction group.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct LookupEntry(u32);

/// Bits of a function's number.
const FUNCTION_BITS: u32 = MAX_POINTS.trailing_zeros();

impl LookupEntry {
    /// Number of the function, over all levels.
    #[inline]
    pub fn function(self) -> u32 {
        self.0 & (MAX_POINTS as u32 - 1)
    }

    /// Its reconstruction group.
    #[inline]
    pub fn group(self) -> u32 {
        self.0 >> FUNCTION_BITS
    }
}

/// The tables of all levels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lookup {
    /// Number of levels, [`LEVEL_WORDS`] words per level (coarsest first), bucket offsets, entries over all levels. Bucket
    /// `b` of a level holds `words[words[first + b]..words[first + b + 1]]`, ascending by function; cells in the same
    /// bucket share its functions. At the end, from the last word down, the reconstruction group of each material.
    pub words: Vec<u32>,
}

impl Lookup {
    /// Builds the tables of all levels, without groups of materials.
    pub fn new(functions: &Functions<'_>) -> Self {
        let &Functions { points, levels, groups, .. } = functions;
        let mut words = vec![0; 1 + LEVEL_WORDS * levels.len()];
        words[0] = levels.len() as u32;
        for (l, level) in levels.iter().enumerate() {
            let points = &points[level.first as usize..(level.first + level.count) as usize];
            let grid = Grid::new(points);
            let buckets = (4 * points.len()).next_power_of_two();
            let head = 1 + LEVEL_WORDS * l;
            words[head] = grid.cells_per_unit.to_bits();
            words[head + 1] = words.len() as u32;
            words[head + 2] = buckets as u32 - 1;
            append(&mut words, &grid, functions, l, buckets);
            if !groups.is_empty() {
                let entries = words[head + 1] as usize + buckets + 1;
                for entry in &mut words[entries..] {
                    *entry |= functions.group_of(*entry as usize) << FUNCTION_BITS;
                }
            }
        }
        Self { words }
    }

    /// Appends the reconstruction groups of `count` materials, the first one last.
    pub fn add_materials(&mut self, count: usize, group_of: impl Fn(u32) -> u32) {
        self.words.extend((0..count as u32).rev().map(group_of));
    }

    /// Returns the functions of a level that may cover a place of a reconstruction group, ascending; some may be of other
    /// groups.
    #[inline]
    pub fn entries(&self, level: usize, position: Vec3, group: u32) -> &[LookupEntry] {
        let head = 1 + LEVEL_WORDS * level;
        let cell = (position * f32::from_bits(self.words[head])).floor().as_ivec3();
        let bucket = (self.words[head + 1] + (hash(cell, group) & self.words[head + 2])) as usize;
        bytemuck::cast_slice(&self.words[self.words[bucket] as usize..self.words[bucket + 1] as usize])
    }

    /// Returns the functions that cover a place of a reconstruction group, with their weights: those of the finest of the
    /// first `levels` levels that has any there; as find.wgsl. `points` are all functions of these levels, with their `cuts`.
    pub fn covering(
        &self,
        levels: usize,
        (points, cuts): (&[Point], &[Cut]),
        (position, normal): (Vec3, Vec3),
        group: u32,
    ) -> Vec<(u32, f32)> {
        for level in (0..levels).rev() {
            let entries = self.entries(level, position, group).iter().filter(|entry| entry.group() == group);
            let weights = entries.map(|entry| {
                let point = &points[entry.function() as usize];
                let offset = position - point.position();
                let is_cut = cuts[point.cuts()].iter().any(|cut| cut.ends(offset));
                let own = if is_cut { 0.0 } else { weight(offset, normal, point.normal(), point.radius) };
                (entry.function(), own)
            });
            let found: Vec<(u32, f32)> = weights.filter(|(_, weight)| *weight > 0.0).collect();
            if found.iter().map(|(_, weight)| weight).sum::<f32>() > LEAST_WEIGHT {
                return found;
            }
        }
        Vec::new()
    }

    /// Returns the number of functions in the fullest bucket of a level.
    pub fn fullest(&self, level: usize) -> usize {
        let head = 1 + LEVEL_WORDS * level;
        let first = self.words[head + 1] as usize;
        let offsets = &self.words[first..first + self.words[head + 2] as usize + 2];
        offsets.windows(2).map(|w| (w[1] - w[0]) as usize).max().unwrap_or(0)
    }
}

/// Appends a level's offsets and lists: counts first, then places.
fn append(words: &mut Vec<u32>, grid: &Grid, functions: &Functions<'_>, level: usize, buckets: usize) {
    let offsets = words.len();
    words.resize(offsets + buckets + 1, 0);
    let placed = grid.buckets(functions, level, buckets);
    placed.iter().for_each(|(bucket, _)| words[offsets + *bucket as usize + 1] += 1);
    words[offsets] = (offsets + buckets + 1) as u32;
    for b in 0..buckets {
        words[offsets + b + 1] += words[offsets + b];
    }
    let mut next = words[offsets..offsets + buckets].to_vec();
    let end = words[offsets + buckets] as usize;
    words.resize(end, 0);
    for (bucket, i) in placed {
        let next = &mut next[bucket as usize];
        words[*next as usize] = i;
        *next += 1;
    }
}

/// The grid of a level.
struct Grid {
    cells_per_unit: f32,
}

impl Grid {
    fn new(points: &[Point]) -> Self {
        let largest = points.iter().fold(0f32, |m, p| m.max(p.radius));
        Self { cells_per_unit: if largest > 0.0 { 1.0 / (CELL * largest) } else { 1.0 } }
    }

    /// Returns pairs of bucket (below `buckets`) and function of a level: functions ascending, once per bucket.
    fn buckets(&self, functions: &Functions<'_>, level: usize, buckets: usize) -> Vec<(u32, u32)> {
        let level = &functions.levels[level];
        let mut placed = Vec::with_capacity(8 * level.count as usize);
        // The last function put into each bucket: two cells of one function may share a bucket.
        let mut last = vec![u32::MAX; buckets];
        for i in level.first..level.first + level.count {
            let (point, group) = (&functions.points[i as usize], functions.group_of(i as usize));
            self.place(point, [i, group], &mut last, &mut placed);
        }
        placed
    }

    /// Inserts a function of a group into the cells that its support may reach: an ellipsoid, flat along the normal. Not
    /// inlined, since a browser runs wasm at full speed only from a later call of a function on.
    #[inline(never)]
    fn place(&self, point: &Point, [i, group]: [u32; 2], last: &mut [u32], placed: &mut Vec<(u32, u32)>) {
        let (centre, normal) = (point.position(), point.normal());
        let radius = MARGIN * point.radius;
        let thickness = radius / (1.0 + SQUASH);
        let n2 = normal * normal;
        let half =
            (radius * radius * (Vec3::ONE - n2) + thickness * thickness * n2).max(Vec3::ZERO).map(f32::sqrt);
        let first = ((centre - half) * self.cells_per_unit).floor().as_ivec3();
        let last_cell = ((centre + half) * self.cells_per_unit).floor().as_ivec3();
        let size = 1.0 / self.cells_per_unit;
        let side = 0.5 * size;
        let thickest = thickness + side * normal.abs().element_sum();
        // Offset from the support's centre to the cell's along an axis, and squared distance to the cell's nearest
        // side.
        let along = |cell: i32, centre: f32| {
            let offset = (cell as f32 + 0.5) * size - centre;
            let nearest = (offset.abs() - side).max(0.0);
            (offset, nearest * nearest)
        };
        for z in first.z..=last_cell.z {
            let (offset_z, near_z) = along(z, centre.z);
            for y in first.y..=last_cell.y {
                let (offset_y, near_y) = along(y, centre.y);
                let (above, near) = (offset_z * normal.z + offset_y * normal.y, near_z + near_y);
                for x in first.x..=last_cell.x {
                    let (offset_x, near_x) = along(x, centre.x);
                    if near + near_x <= radius * radius && (above + offset_x * normal.x).abs() <= thickest {
                        let bucket = hash(IVec3::new(x, y, z), group) as usize & (last.len() - 1);
                        if std::mem::replace(&mut last[bucket], i) != i {
                            placed.push((bucket as u32, i));
                        }
                    }
                }
            }
        }
    }
}

/// As `cell_hash` in lookup.wgsl.
#[inline]
fn hash(cell: IVec3, group: u32) -> u32 {
    let [x, y, z] = cell.to_array().map(|c| c as u32);
    let h = x.wrapping_mul(0x8da6_b343)
        ^ y.wrapping_mul(0xd816_3841)
        ^ z.wrapping_mul(0xcb1a_b31f)
        ^ group.wrapping_mul(0x85eb_ca6b);
    (h ^ (h >> 15)).wrapping_mul(0x9e37_79b9) >> 3
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::baked::BakedScene;
    use crate::octahedral::pack_snorm16;
    use crate::rbn::meta::Level;

    fn random(seed: u32) -> f32 {
        let x = (seed ^ 0x85eb_ca6b).wrapping_mul(0x9e37_79b9);
        let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
        ((x ^ (x >> 16)) >> 8) as f32 / (1 << 24) as f32
    }

    fn place(seed: u32) -> Vec3 {
        Vec3::new(random(3 * seed), random(3 * seed + 1), random(3 * seed + 2)) * 4.0 - 2.0
    }

    fn scene() -> BakedScene {
        let mut scene = BakedScene::default();
        for count in [40, 700] {
            let first = scene.points.len() as u32;
            for i in first..first + count {
                scene.points.push(Point {
                    position: place(i).to_array(),
                    radius: (0.2 + 0.3 * random(i + 9000)) * if count == 40 { 3.0 } else { 1.0 },
                    normal: pack_snorm16(place(i + 5000).normalize()),
                    cuts: 0,
                    tint: 0,
                });
            }
            scene.meta.levels.push(Level { first, count, ..Level::default() });
        }
        scene
    }

    fn functions<'a>(scene: &'a BakedScene, groups: &'a [u32]) -> Functions<'a> {
        Functions { points: &scene.points, cuts: &scene.cuts, levels: &scene.meta.levels, groups }
    }

    #[test]
    fn a_bucket_holds_every_function_that_covers_a_place_once() {
        let scene = scene();
        let groups: Vec<u32> = (0..scene.points.len() as u32).map(|i| i % 3 * 500).collect();
        let lookup = Lookup::new(&functions(&scene, &groups));
        let (mut found, mut tested) = (0, 0);
        for i in 0..4000 {
            let (x, normal) = (place(i + 20_000), place(i + 40_000).normalize());
            for l in 0..2 {
                for group in [0, 500, 1000] {
                    let entries = lookup.entries(l, x, group);
                    assert!(entries.iter().all(|entry| entry.group() == groups[entry.function() as usize]));
                    let list: Vec<u32> = entries.iter().map(|entry| entry.function()).collect();
                    assert!(list.len() <= lookup.fullest(l));
                    assert!(list.windows(2).all(|w| w[0] < w[1]), "each function once");
                    assert!(list.iter().all(|&j| scene.level(l).contains(&(j as usize))));
                    let covers = |j: &usize| {
                        let p = &scene.points[*j];
                        groups[*j] == group && weight(x - p.position(), normal, p.normal(), p.radius) > 0.0
                    };
                    for j in scene.level(l).filter(covers) {
                        assert!(list.contains(&(j as u32)));
                        found += 1;
                    }
                    tested += list.len();
                }
            }
        }
        // Brute force would test all points at each place.
        assert!(found > 1000 && 8 * tested < 4000 * scene.points.len(), "{found} of {tested}");
    }

    #[test]
    fn a_scene_without_functions_has_empty_tables() {
        let mut scene = BakedScene::default();
        assert_eq!(Lookup::new(&functions(&scene, &[])).words, [0]);
        scene.meta.levels.push(Level::default());
        let lookup = Lookup::new(&functions(&scene, &[]));
        assert!(lookup.entries(0, Vec3::ONE, 0).is_empty() && lookup.fullest(0) == 0);
    }
}
