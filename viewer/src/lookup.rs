//! Which functions may cover a place: a hash grid per level, made once when a scene is loaded.
//!
//! A pixel reads one bucket of its level and tests the functions in it; lookup.wgsl reads what is made here.

use crate::error::ViewerError;
use crate::upload::MAX_BINDING;
use glam::{IVec3, Vec3};
use rebounce_shared::kernel::SQUASH;
use rebounce_shared::rbn::Scene;
use rebounce_shared::rbn::bulk::Point;

/// Words of a level at the begin: one over the cell size (f32), first bucket, number of buckets less one.
pub const LEVEL_WORDS: usize = 3;
/// Width of a cell over the largest support radius of its level.
const CELL: f32 = 0.6;
/// Supports count as this much larger, so that a cell's rim may round to either side.
const MARGIN: f32 = 1.001;

/// The tables of all levels in one array: the number of levels, [`LEVEL_WORDS`] words a level (coarsest first),
/// the buckets' offsets, the functions' indices over all levels. Bucket `b` of a level holds
/// `words[words[first + b]..words[first + b + 1]]`; cells that share a bucket share its functions.
///
/// # Errors
/// [`ViewerError::TooLarge`] past one storage binding.
pub fn build(scene: &Scene) -> Result<Vec<u32>, ViewerError> {
    let levels = scene.meta.levels.len();
    let mut words = vec![0; 1 + LEVEL_WORDS * levels];
    words[0] = levels as u32;
    for l in 0..levels {
        let range = scene.level(l);
        let points = &scene.points[range.clone()];
        let grid = Grid::new(points);
        let buckets = (4 * points.len()).next_power_of_two();
        let head = 1 + LEVEL_WORDS * l;
        words[head] = grid.cells_per_unit.to_bits();
        words[head + 1] = words.len() as u32;
        words[head + 2] = buckets as u32 - 1;
        append(&mut words, &grid, points, range.start as u32, buckets);
        let bytes = 4 * words.len() as u64;
        if bytes > MAX_BINDING {
            return Err(ViewerError::TooLarge { section: "PNTS", bytes, limit: MAX_BINDING });
        }
    }
    Ok(words)
}

/// Appends a level's offsets and lists: counts first, then places.
fn append(words: &mut Vec<u32>, grid: &Grid, points: &[Point], first: u32, buckets: usize) {
    let offsets = words.len();
    words.resize(offsets + buckets + 1, 0);
    let placed = grid.buckets(points, first, buckets);
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

    /// Buckets, of so many, and the functions in them, counted from `first`: functions ascending, each once a bucket.
    fn buckets(&self, points: &[Point], first: u32, buckets: usize) -> Vec<(u32, u32)> {
        let mut placed = Vec::new();
        // The last function put into each bucket: two cells of one function may share a bucket.
        let mut last = vec![u32::MAX; buckets];
        for (point, i) in points.iter().zip(first..) {
            self.cells(point, |cell| {
                let bucket = hash(cell) as usize & (buckets - 1);
                if std::mem::replace(&mut last[bucket], i) != i {
                    placed.push((bucket as u32, i));
                }
            });
        }
        placed
    }

    /// The cells that a point's support may reach into: an ellipsoid, flat along the normal. Not inlined: a browser runs
    /// wasm at full speed only from some call of a function on.
    #[inline(never)]
    fn cells(&self, point: &Point, mut visit: impl FnMut(IVec3)) {
        let (centre, normal) = (point.position(), point.normal());
        let radius = MARGIN * point.radius;
        let thickness = radius / (1.0 + SQUASH);
        let n2 = normal * normal;
        let half =
            (radius * radius * (Vec3::ONE - n2) + thickness * thickness * n2).max(Vec3::ZERO).map(f32::sqrt);
        let first = ((centre - half) * self.cells_per_unit).floor().as_ivec3();
        let last = ((centre + half) * self.cells_per_unit).floor().as_ivec3();
        let side = 0.5 / self.cells_per_unit;
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let cell = IVec3::new(x, y, z);
                    let offset = (cell.as_vec3() + 0.5) / self.cells_per_unit - centre;
                    let nearest = (offset.abs() - side).max(Vec3::ZERO);
                    let above = offset.dot(normal).abs() - side * normal.abs().element_sum();
                    if nearest.length_squared() <= radius * radius && above <= thickness {
                        visit(cell);
                    }
                }
            }
        }
    }
}

/// As `cell_hash` in lookup.wgsl.
fn hash(cell: IVec3) -> u32 {
    let [x, y, z] = cell.to_array().map(|c| c as u32);
    let h = x.wrapping_mul(0x8da6_b343) ^ y.wrapping_mul(0xd816_3841) ^ z.wrapping_mul(0xcb1a_b31f);
    (h ^ (h >> 15)).wrapping_mul(0x9e37_79b9) >> 3
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::kernel::weight;
    use rebounce_shared::octahedral::pack_snorm16;
    use rebounce_shared::rbn::meta::Level;

    fn random(seed: u32) -> f32 {
        let x = (seed ^ 0x85eb_ca6b).wrapping_mul(0x9e37_79b9);
        let x = (x ^ (x >> 15)).wrapping_mul(0x846c_a68b);
        ((x ^ (x >> 16)) >> 8) as f32 / (1 << 24) as f32
    }

    fn place(seed: u32) -> Vec3 {
        Vec3::new(random(3 * seed), random(3 * seed + 1), random(3 * seed + 2)) * 4.0 - 2.0
    }

    fn scene() -> Scene {
        let mut scene = Scene::default();
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

    #[test]
    fn a_bucket_holds_every_function_that_covers_a_place_once() {
        let scene = scene();
        let words = build(&scene).unwrap();
        let (mut found, mut tested) = (0, 0);
        for i in 0..4000 {
            let (x, normal) = (place(i + 20_000), place(i + 40_000).normalize());
            for l in 0..2 {
                let head = 1 + LEVEL_WORDS * l;
                let cell = (x * f32::from_bits(words[head])).floor().as_ivec3();
                let bucket = (words[head + 1] + (hash(cell) & words[head + 2])) as usize;
                let list = &words[words[bucket] as usize..words[bucket + 1] as usize];
                assert!(list.windows(2).all(|w| w[0] < w[1]), "each function once");
                assert!(list.iter().all(|&j| scene.level(l).contains(&(j as usize))));
                let covers = |j: &usize| {
                    let p = &scene.points[*j];
                    weight(x - p.position(), normal, p.normal(), p.radius) > 0.0
                };
                for j in scene.level(l).filter(covers) {
                    assert!(list.contains(&(j as u32)));
                    found += 1;
                }
                tested += list.len();
            }
        }
        // Brute force would test all points at each place.
        assert!(found > 1000 && 8 * tested < 4000 * scene.points.len(), "{found} of {tested}");
    }

    #[test]
    fn a_scene_without_functions_has_empty_tables() {
        let mut scene = Scene::default();
        assert_eq!(build(&scene).unwrap(), [0]);
        scene.meta.levels.push(Level::default());
        let words = build(&scene).unwrap();
        assert_eq!(words[words[2] as usize], words[words[2] as usize + 1]);
    }
}
