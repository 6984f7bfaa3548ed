//! Which functions cover a place, and with what weight.
//!
//! A hash grid per level: each cell lists the functions whose support's box touches it, so a
//! query reads one list. `cargo bench -p rebounce --bench basis` compares it with an R-tree (paper, 2.1).

use glam::{IVec3, Vec3};
use rebounce_shared::kernel::{SQUASH, weight};
use rebounce_shared::rbn::bulk::Cut;

/// A basis function.
#[derive(Clone, Copy, Debug)]
pub struct Support<'a> {
    /// Its point, local space.
    pub position: Vec3,
    /// The point's unit normal.
    pub normal: Vec3,
    /// Radius of the support, scene units.
    pub radius: f32,
    /// Planes that end it.
    pub cuts: &'a [Cut],
}

/// A function as queries read it. 40 bytes.
#[derive(Clone, Copy, Debug)]
struct Function {
    position: Vec3,
    radius: f32,
    normal: Vec3,
    index: u32,
    first_cut: u32,
    cut_count: u32,
}

/// Evaluates one level's functions.
pub struct Evaluator {
    cuts: Vec<Cut>,
    cell_size: f32,
    low: Vec3,
    /// Open addressing: cell key and where its list begins and ends; `u64::MAX` is empty.
    table: Vec<(u64, u32, u32)>,
    /// The cells' functions, repeated for each cell: a query reads one run of memory.
    lists: Vec<Function>,
}

impl Evaluator {
    /// Queries name functions by `first_index` + their place in this list.
    pub fn new<'a>(functions: impl IntoIterator<Item = Support<'a>>, first_index: u32) -> Self {
        let mut all_cuts = Vec::new();
        let functions: Vec<Function> = functions
            .into_iter()
            .zip(first_index..)
            .map(|(Support { position, normal, radius, cuts }, index)| {
                let (first_cut, cut_count) = (all_cuts.len() as u32, cuts.len() as u32);
                all_cuts.extend_from_slice(cuts);
                Function { position, radius, normal, index, first_cut, cut_count }
            })
            .collect();
        let low = functions.iter().fold(Vec3::INFINITY, |m, f| m.min(f.position - f.radius));
        let low = if low.is_finite() { low } else { Vec3::ZERO };
        let largest = functions.iter().fold(0f32, |m, f| m.max(f.radius));
        let cell_size = if largest > 0.0 { 0.75 * largest } else { 1.0 };
        let cells_of = |f: &Function| {
            // The box of an ellipsoid with semi-axes r, r and r / (1 + F_squash) along the normal.
            let flat = 1.0 / (1.0 + SQUASH);
            let n2 = f.normal * f.normal;
            let half = f.radius * (Vec3::ONE - n2 * (1.0 - flat * flat)).max(Vec3::ZERO).map(f32::sqrt);
            let first = ((f.position - half - low) / cell_size).floor().as_ivec3();
            let last = ((f.position + half - low) / cell_size).floor().as_ivec3();
            (first, last)
        };
        let mut pairs: Vec<(u64, u32)> = Vec::new();
        for (i, f) in functions.iter().enumerate() {
            let (first, last) = cells_of(f);
            for z in first.z..=last.z {
                for y in first.y..=last.y {
                    for x in first.x..=last.x {
                        pairs.push((key(IVec3::new(x, y, z)), i as u32));
                    }
                }
            }
        }
        pairs.sort_unstable();
        let cells = pairs.chunk_by(|a, b| a.0 == b.0).count();
        let mut table = vec![(u64::MAX, 0, 0); (2 * cells + 1).next_power_of_two()];
        let mask = table.len() - 1;
        let mut start = 0u32;
        for cell in pairs.chunk_by(|a, b| a.0 == b.0) {
            let end = start + cell.len() as u32;
            let mut slot = slot(cell[0].0) & mask;
            while table[slot].0 != u64::MAX {
                slot = (slot + 1) & mask;
            }
            table[slot] = (cell[0].0, start, end);
            start = end;
        }
        let lists = pairs.into_iter().map(|(_, i)| functions[i as usize]).collect();
        Self { cuts: all_cuts, cell_size, low, table, lists }
    }

    /// Calls `visit(index, weight)` for each function whose weight (Eq. 8) is positive at this
    /// place and that no cut ends there, and returns the weights' sum: 0 where nothing covers it.
    #[inline]
    pub fn gather(&self, position: Vec3, normal: Vec3, mut visit: impl FnMut(u32, f32)) -> f32 {
        let wanted = key(((position - self.low) / self.cell_size).floor().as_ivec3());
        let mask = self.table.len() - 1;
        let mut slot = slot(wanted) & mask;
        let mut total = 0.0;
        loop {
            let (key, start, end) = self.table[slot];
            if key == wanted {
                for f in &self.lists[start as usize..end as usize] {
                    let offset = position - f.position;
                    let w = weight(offset, normal, f.normal, f.radius);
                    let cuts = &self.cuts[f.first_cut as usize..(f.first_cut + f.cut_count) as usize];
                    if w > 0.0 && !cuts.iter().any(|cut| cut.ends(offset)) {
                        total += w;
                        visit(f.index, w);
                    }
                }
                return total;
            }
            if key == u64::MAX {
                return total;
            }
            slot = (slot + 1) & mask;
        }
    }
}

#[inline]
fn key(cell: IVec3) -> u64 {
    const MASK: u64 = (1 << 21) - 1;
    (cell.x as u64 & MASK) | (cell.y as u64 & MASK) << 21 | (cell.z as u64 & MASK) << 42
}

#[inline]
fn slot(key: u64) -> usize {
    let h = key.wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (h ^ (h >> 32)) as usize
}

/// Evaluators for several levels: a place takes the finest level that covers it.
pub struct Leveled {
    /// Coarsest first.
    levels: Vec<Evaluator>,
}

impl Leveled {
    /// From levels, coarsest first.
    pub fn new(levels: Vec<Evaluator>) -> Self {
        Self { levels }
    }

    /// Fills `out` with (index, normalised weight) of the functions of the finest level that
    /// covers this place; the weights sum to 1. Leaves it empty where no level does.
    #[inline]
    pub fn interpolate(&self, position: Vec3, normal: Vec3, out: &mut Vec<(u32, f32)>) {
        for level in self.levels.iter().rev() {
            out.clear();
            let total = level.gather(position, normal, |i, w| out.push((i, w)));
            // A weight so small that its share is noise does not count as covered.
            if total > 1e-6 {
                let scale = 1.0 / total;
                out.iter_mut().for_each(|e| e.1 *= scale);
                return;
            }
        }
        out.clear();
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
                }
            })
            .collect()
    }

    #[test]
    fn grid_finds_what_brute_force_finds() {
        let functions = functions(500);
        let grid = Evaluator::new(functions.iter().copied(), 10);
        let mut found = 0;
        for i in 0..5000 {
            let mut s = Stream::new(8, i);
            let (x, n) = (Vec3::new(s.unit(), s.unit(), s.unit()) * 1.4 - 0.2, s.sphere());
            let mut got = Vec::new();
            grid.gather(x, n, |i, w| got.push((i, w)));
            got.sort_by_key(|e| e.0);
            let want: Vec<(u32, f32)> = functions
                .iter()
                .zip(10..)
                .filter(|(f, _)| !f.cuts.iter().any(|cut| cut.ends(x - f.position)))
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
            leveled.interpolate(Vec3::new(s.unit(), s.unit(), s.unit()), s.sphere(), &mut out);
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
