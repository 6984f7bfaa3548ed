//! Evaluator: finds the basis functions that cover a position, and their weights.
//!
//! A hash grid per level: each bucket lists the functions whose supports overlap the bucket's
//! cells. A query rejects the functions of the list that cannot cover the position, four at a time,
//! and evaluates the remaining functions. `cargo bench -p rebounce --bench basis` compares the grid
//! with an R-tree (paper, 2.1).

use crate::processor;
use glam::{IVec3, Mat4, Vec3, Vec4};
use rebounce_shared::baked::BakedScene;
use rebounce_shared::kernel::{LEAST_COSINE, LEAST_WEIGHT, SQUASH, weight};
use rebounce_shared::rbn::bulk::Cut;

/// Support of a basis function.
#[derive(Clone, Copy, Debug)]
pub struct Support<'a> {
    /// Position of the function's point, local space.
    pub position: Vec3,
    /// Unit normal of the point.
    pub normal: Vec3,
    /// Radius of the support, scene units.
    pub radius: f32,
    /// Clip planes of the support.
    pub cuts: &'a [Cut],
    /// [Reconstruction group](rebounce_shared::rbn::groups): the function covers no surface of another.
    pub group: u32,
}

/// Ratio of a cell's width to the largest support radius.
const CELL: f32 = 0.75;
/// Factor on support radii in the rejection test, so that rounding rejects no covering function.
const MARGIN: f32 = 1.001;
/// Functions per rejection test (SIMD lanes).
const LANES: usize = 4;

/// A function in the form that queries read: half a cache line.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
struct Function {
    /// Position, and radius in w.
    place: Vec4,
    /// Unit normal, and the reconstruction group in w.
    facing: Vec4,
}

impl Function {
    /// Empty function: all comparisons with NaN fail.
    const NONE: Self = Self { place: Vec4::NAN, facing: Vec4::NAN };

    fn position(&self) -> Vec3 {
        self.place.truncate()
    }

    fn normal(&self) -> Vec3 {
        self.facing.truncate()
    }

    fn radius(&self) -> f32 {
        self.place.w
    }
}

/// Step of [`Evaluator::fetch`]: each reads what the one before has fetched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FetchStep {
    /// The bucket of the position.
    Bucket,
    /// The begin of the bucket's list.
    List,
    /// The functions of the list.
    Functions,
}

/// Evaluates the functions of a level.
pub struct Evaluator {
    /// Functions in input order, followed by [`Function::NONE`].
    functions: Vec<Function>,
    first_index: u32,
    /// Largest support radius, scene units.
    radius: f32,
    /// Index of each function's first clip plane, and the total number of clip planes.
    first_cuts: Vec<u32>,
    cuts: Vec<Cut>,
    cells_per_unit: f32,
    low: Vec3,
    /// Index of each bucket's first list entry, and the number of list entries.
    starts: Vec<u32>,
    /// The buckets' functions, ascending, padded with the empty function.
    lists: Vec<[u32; LANES]>,
}

impl Evaluator {
    /// Builds the grid. Queries return `first_index` plus the function's position in `supports`.
    pub fn new<'a>(supports: impl IntoIterator<Item = Support<'a>>, first_index: u32) -> Self {
        let (mut cuts, mut first_cuts) = (Vec::new(), vec![0]);
        let mut functions: Vec<Function> = Vec::new();
        for Support { position, normal, radius, cuts: own, group } in supports {
            functions.push(Function { place: position.extend(radius), facing: normal.extend(group as f32) });
            cuts.extend_from_slice(own);
            first_cuts.push(cuts.len() as u32);
        }
        let low = functions.iter().fold(Vec3::INFINITY, |m, f| m.min(f.position() - f.radius()));
        let low = if low.is_finite() { low } else { Vec3::ZERO };
        let largest = functions.iter().fold(0f32, |m, f| m.max(f.radius()));
        let cells_per_unit = if largest > 0.0 { 1.0 / (CELL * largest) } else { 1.0 };
        let mut grid = Self {
            functions,
            first_index,
            radius: largest,
            first_cuts,
            cuts,
            cells_per_unit,
            low,
            starts: Vec::new(),
            lists: Vec::new(),
        };
        grid.fill();
        grid.functions.push(Function::NONE);
        grid
    }

    /// Fills the buckets' lists.
    fn fill(&mut self) {
        let buckets = (8 * self.functions.len()).next_power_of_two().max(BLOCK as usize);
        self.starts = vec![0; buckets + 1];
        let nothing = self.functions.len() as u32;
        // Pairs of bucket and function, functions ascending; two cells of a function may share a bucket.
        let (mut placed, mut last): (Vec<(u32, u32)>, _) = (Vec::new(), vec![nothing; buckets]);
        for (i, function) in (0u32..).zip(&self.functions) {
            self.cells(function, |cell| {
                let bucket = self.bucket(cell);
                if std::mem::replace(&mut last[bucket], i) != i {
                    placed.push((bucket as u32, i));
                }
            });
        }
        // Number of functions in each bucket, then the place of each bucket's next function.
        let mut next = vec![0usize; buckets];
        placed.iter().for_each(|(bucket, _)| next[*bucket as usize] += 1);
        let mut lists = 0;
        for (start, next) in self.starts.iter_mut().zip(&mut next) {
            *start = lists as u32;
            lists += std::mem::replace(next, lists * LANES).div_ceil(LANES);
        }
        self.starts[buckets] = lists as u32;
        self.lists = vec![[nothing; LANES]; lists];
        for (bucket, i) in placed {
            let next = &mut next[bucket as usize];
            self.lists.as_flattened_mut()[*next] = i;
            *next += 1;
        }
    }

    /// Visits the cells that overlap a function's support: an ellipsoid with semi-axes r, r and r /
    /// (1 + F_squash) along the normal.
    fn cells(&self, function: &Function, mut visit: impl FnMut(IVec3)) {
        let (centre, normal) = ((function.position() - self.low) * self.cells_per_unit, function.normal());
        let radius = MARGIN * function.radius() * self.cells_per_unit;
        let thickness = radius / (1.0 + SQUASH);
        let n2 = normal * normal;
        let half =
            (radius * radius * (Vec3::ONE - n2) + thickness * thickness * n2).max(Vec3::ZERO).map(f32::sqrt);
        let (first, last) = ((centre - half).floor().as_ivec3(), (centre + half).floor().as_ivec3());
        // Greatest distance of a cell's centre from the support's tangent plane.
        let thickest = thickness + 0.5 * MARGIN * normal.abs().element_sum();
        for z in first.z..=last.z {
            for y in first.y..=last.y {
                for x in first.x..=last.x {
                    let cell = IVec3::new(x, y, z);
                    let middle = cell.as_vec3() + 0.5 - centre;
                    let nearest = (middle.abs() - 0.5).max(Vec3::ZERO);
                    if nearest.length_squared() <= radius * radius && middle.dot(normal).abs() <= thickest {
                        visit(cell);
                    }
                }
            }
        }
    }

    /// Bucket of a cell. Adjacent cells share a block; buckets of a block, and their lists, are
    /// adjacent in memory.
    #[inline]
    fn bucket(&self, cell: IVec3) -> usize {
        let [x, y, z] = cell.to_array().map(|c| c as u32);
        let mixed = (x >> 1).wrapping_mul(0x8da6_b343)
            ^ (y >> 1).wrapping_mul(0xd816_3841)
            ^ (z >> 1).wrapping_mul(0xcb1a_b31f);
        let block = (mixed ^ (mixed >> 15)).wrapping_mul(0x9e37_79b9) >> 3;
        let within = (x & 1) | ((y & 1) << 1) | ((z & 1) << 2);
        ((block * BLOCK) | within) as usize & (self.starts.len() - 2)
    }

    /// Prefetches, in steps, what a query at this position reads: its bucket, the bucket's list, the list's functions.
    #[inline]
    pub fn fetch(&self, position: Vec3, step: FetchStep) {
        let bucket = self.bucket_at(position);
        match step {
            FetchStep::Bucket => processor::fetch(&self.starts, bucket),
            FetchStep::List => processor::fetch(&self.lists, self.starts[bucket] as usize),
            FetchStep::Functions => {
                let lists = self.starts[bucket] as usize..self.starts[bucket + 1] as usize;
                for function in self.lists[lists].iter().flatten() {
                    processor::fetch(&self.functions, *function as usize);
                }
            }
        }
    }

    /// Bucket of a position.
    #[inline]
    fn bucket_at(&self, position: Vec3) -> usize {
        let place = (position - self.low) * self.cells_per_unit;
        // Floor without a call into the system's library.
        self.bucket(place.as_ivec3() - IVec3::from(place.cmplt(Vec3::ZERO)))
    }

    /// Calls `visit(index, weight)` for each function of a reconstruction group with a positive weight (Eq. 8) at
    /// this position and no clip plane in between, and returns the sum of weights: 0 if no function
    /// covers the position.
    #[inline]
    pub fn gather(&self, position: Vec3, normal: Vec3, group: u32, mut visit: impl FnMut(u32, f32)) -> f32 {
        let bucket = self.bucket_at(position);
        let mut total = 0.0;
        for lanes in &self.lists[self.starts[bucket] as usize..self.starts[bucket + 1] as usize] {
            let mut hopeful = self.hopeful(lanes, position, normal, group);
            while hopeful != 0 {
                let place = lanes[hopeful.trailing_zeros() as usize] as usize;
                hopeful &= hopeful - 1;
                let function = &self.functions[place];
                let offset = position - function.position();
                let w = weight(offset, normal, function.normal(), function.radius());
                if w > 0.0 && !self.cuts(place).iter().any(|cut| cut.ends(offset)) {
                    total += w;
                    visit(self.first_index + place as u32, w);
                }
            }
        }
        total
    }

    /// Clip planes of a function.
    #[inline]
    fn cuts(&self, place: usize) -> &[Cut] {
        &self.cuts[self.first_cuts[place] as usize..self.first_cuts[place + 1] as usize]
    }

    /// Rejection test: a bit for each of the four functions, set if the function may cover the
    /// position. A set bit may be false by the margin; a cleared bit is exact.
    #[inline]
    fn hopeful(&self, lanes: &[u32; LANES], position: Vec3, normal: Vec3, group: u32) -> u32 {
        let [a, b, c, d] = lanes.map(|i| &self.functions[i as usize]);
        let place = Mat4::from_cols(a.place, b.place, c.place, d.place).transpose();
        let facing = Mat4::from_cols(a.facing, b.facing, c.facing, d.facing).transpose();
        let (x, y, z) = (position.x - place.x_axis, position.y - place.y_axis, position.z - place.z_axis);
        let height = x * facing.x_axis + y * facing.y_axis + z * facing.z_axis;
        let cosine = normal.x * facing.x_axis + normal.y * facing.y_axis + normal.z * facing.z_axis;
        // Squared distance of Eq. 10, for a unit normal.
        const SQUASHED: f32 = SQUASH * (2.0 + SQUASH);
        let distance = x * x + y * y + z * z + SQUASHED * height * height;
        let radius = MARGIN * place.w_axis;
        let is_near = distance.cmplt(radius * radius) & cosine.cmpgt(Vec4::splat(LEAST_COSINE / MARGIN));
        (is_near & facing.w_axis.cmpeq(Vec4::splat(group as f32))).bitmask()
    }
}

/// A level among those that cover a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoveringLevel {
    /// Whether no coarser level covers the position.
    pub is_coarsest: bool,
    /// Whether no finer level covers the position.
    pub is_finest: bool,
}

/// Cells per block, two along each axis.
const BLOCK: u32 = 8;

/// Evaluators of several levels; a query uses the finest level that covers the position.
pub struct Leveled {
    /// Evaluators, coarsest first.
    levels: Vec<Evaluator>,
}

impl Leveled {
    /// Combines evaluators of levels, coarsest first.
    pub fn new(levels: Vec<Evaluator>) -> Self {
        Self { levels }
    }

    /// The functions of all levels of a file.
    pub fn of_baked(scene: &BakedScene) -> Self {
        let level = |l: usize| {
            let range = scene.level(l);
            let support = |i: usize| {
                let p = &scene.points[i];
                Support {
                    position: p.position(),
                    normal: p.normal(),
                    radius: p.radius,
                    cuts: scene.cuts_of(i),
                    group: scene.group_of(i),
                }
            };
            Evaluator::new(range.clone().map(support), range.start as u32)
        };
        Self::new((0..scene.meta.levels.len()).map(level).collect())
    }

    /// Fills `out` with (index, normalised weight) of a reconstruction group's functions of the finest level that
    /// covers this position; the weights sum to 1. `out` is empty if no level covers the position.
    #[inline]
    pub fn interpolate(&self, position: Vec3, normal: Vec3, group: u32, out: &mut Vec<(u32, f32)>) {
        for level in self.levels.iter().rev() {
            out.clear();
            let total = level.gather(position, normal, group, |i, w| out.push((i, w)));
            if total > LEAST_WEIGHT {
                let scale = 1.0 / total;
                out.iter_mut().for_each(|e| e.1 *= scale);
                return;
            }
        }
        out.clear();
    }

    /// Calls `visit(level, index, normalised weight)` for the functions of a reconstruction group on every level that covers
    /// this position, coarsest level first; the weights of a level sum to 1.
    pub fn each_level(
        &self,
        position: Vec3,
        normal: Vec3,
        group: u32,
        mut visit: impl FnMut(CoveringLevel, u32, f32),
    ) {
        let total = |level: &Evaluator| level.gather(position, normal, group, |_, _| {});
        let covers = |level: &Evaluator| total(level) > LEAST_WEIGHT;
        let Some(finest) = self.levels.iter().rposition(covers) else { return };
        let mut is_coarsest = true;
        for (l, level) in self.levels[..=finest].iter().enumerate() {
            let total = total(level);
            if total > LEAST_WEIGHT {
                let covering = CoveringLevel { is_coarsest, is_finest: l == finest };
                level.gather(position, normal, group, |function, weight| {
                    visit(covering, function, weight / total)
                });
                is_coarsest = false;
            }
        }
    }

    /// Radius of the finest level's functions, scene units; 0 without levels.
    pub fn finest_radius(&self) -> f32 {
        self.levels.last().map_or(0.0, |level| level.radius)
    }

    /// Radius of the coarsest level's functions, scene units; 0 without levels.
    pub fn coarsest_radius(&self) -> f32 {
        self.levels.first().map_or(0.0, |level| level.radius)
    }

    /// Radius of the finest level that covers this position, scene units; `None` if no level covers
    /// the position.
    pub fn radius_at(&self, position: Vec3, normal: Vec3, group: u32) -> Option<f32> {
        let covers = |level: &&Evaluator| level.gather(position, normal, group, |_, _| {}) > LEAST_WEIGHT;
        self.levels.iter().rev().find(covers).map(|level| level.radius)
    }

    /// Clip planes and position of a function.
    fn cuts(&self, function: u32) -> (&[Cut], Vec3) {
        let level = self.levels.partition_point(|level| level.first_index <= function) - 1;
        let (level, place) = (&self.levels[level], (function - self.levels[level].first_index) as usize);
        (level.cuts(place), level.functions[place].position())
    }

    /// Whether a function has clip planes.
    pub fn has_cuts(&self, function: u32) -> bool {
        !self.cuts(function).0.is_empty()
    }

    /// Whether a clip plane of a function separates these positions.
    pub fn is_cut_between(&self, function: u32, positions: &[Vec3]) -> bool {
        let (cuts, at) = self.cuts(function);
        cuts.iter().any(|cut| {
            let ended = positions.iter().filter(|position| cut.ends(**position - at)).count();
            ended != 0 && ended != positions.len()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    fn functions(n: u64) -> Vec<Support<'static>> {
        const CUT: &[Cut] = &[Cut { towards: [12.0, 5.0, 0.0] }, Cut { towards: [0.0, -9.0, 9.0] }];
        (0..n)
            .map(|i| {
                let mut s = Stream::new(7, i);
                Support {
                    position: Vec3::new(s.unit(), s.unit(), s.unit()),
                    normal: s.sphere(),
                    radius: 0.1 + 0.1 * s.unit(),
                    cuts: &CUT[..(i % 3) as usize],
                    group: (i % 2) as u32 * 700,
                }
            })
            .collect()
    }

    #[test]
    fn grid_finds_what_brute_force_finds() {
        let functions = functions(500);
        let grid = Evaluator::new(functions.iter().copied(), 10);
        let mut found = 0;
        for i in 0..10_000 {
            let mut s = Stream::new(8, i);
            let (x, n) = (Vec3::new(s.unit(), s.unit(), s.unit()) * 1.4 - 0.2, s.sphere());
            let mut got = Vec::new();
            let group = (i % 2) as u32 * 700;
            grid.gather(x, n, group, |i, w| got.push((i, w)));
            got.sort_by_key(|e| e.0);
            let want: Vec<(u32, f32)> = functions
                .iter()
                .zip(10..)
                .filter(|(f, _)| f.group == group && !f.cuts.iter().any(|cut| cut.ends(x - f.position)))
                .map(|(f, i)| (i, weight(x - f.position, n, f.normal, f.radius)))
                .filter(|e| e.1 > 0.0)
                .collect();
            assert_eq!(got, want);
            found += got.len();
        }
        assert!(found > 1000);
    }

    #[test]
    fn weights_are_a_partition_of_unity_on_every_level() {
        let leveled = Leveled::new(vec![
            Evaluator::new(functions(50).into_iter().map(|f| Support { radius: 3.0 * f.radius, ..f }), 0),
            Evaluator::new(functions(800), 50),
        ]);
        let (mut out, mut fine, mut coarse) = (Vec::new(), 0, 0);
        for i in 0..5000 {
            let mut s = Stream::new(9, i);
            leveled.interpolate(Vec3::new(s.unit(), s.unit(), s.unit()), s.sphere(), 700, &mut out);
            if out.is_empty() {
                continue;
            }
            let sum: f32 = out.iter().map(|e| e.1).sum();
            assert!((sum - 1.0).abs() < 1e-5 && out.iter().all(|e| e.1 > 0.0));
            assert!(out.iter().all(|e| (e.0 < 50) == (out[0].0 < 50)));
            if out[0].0 < 50 { coarse += 1 } else { fine += 1 }
        }
        assert!(fine > 100 && coarse > 100, "{fine} {coarse}");
    }
}
