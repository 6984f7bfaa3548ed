//! Parents and children (paper, section 2.1).

use super::least_squares::make_linear;
use super::{Functions, Lookup};
use crate::interpolation::{Entry, Rows, pack_row};
use crate::kernel::{LEAST_WEIGHT, weight};
use crate::rbn::RbnError;

/// Weighting of a point's parents.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ParentWeights {
    /// Shepard's weights (Eq. 7; Shepard 1968): basis functions, normalised; in files up to version 8.
    Shepard,
    /// Shepard's weights made linear by [moving least squares](super::least_squares), kept positive.
    #[default]
    LeastSquares,
}

/// Parents and children of the points, and the lookup of functions by place.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Relations {
    /// Offsets of the push rows, one row per point, plus the end offset.
    pub push_offsets: Vec<u32>,
    /// Parents with their weights at the point. Parents are on the finest coarser level with a function that covers
    /// the point (usually the next coarser level). Empty rows: points of level 0 and points without a coarser
    /// function ("orphans").
    pub push_entries: Vec<Entry>,
    /// Offsets of the pull rows, one row per point of the sampled levels except the finest, plus the end offset.
    pub pull_offsets: Vec<u32>,
    /// Children with their weights.
    pub pull_entries: Vec<Entry>,
    /// Lookup of the functions that may cover a place.
    pub lookup: Lookup,
}

/// Maximum number of functions in a bucket of a level, which is of one reconstruction group but for chance. Poisson-disk spacing leaves a few dozen; a file with
/// coincident points would take unbounded time.
const MOST_IN_A_BUCKET: usize = 2048;
/// Maximum number of functions tested per point in the search for parents, averaged over the points. Scenes need up
/// to a hundred.
const MOST_TESTED: usize = 512;
/// Maximum number of parents per point, averaged over the points. Scenes have about four.
const MOST_PARENTS: usize = 32;
/// Allowance added to both totals, for files with few points.
const MANY: usize = 1 << 16;

impl Relations {
    /// Finds parents of every point with these weights, and children for the first `direct_levels` levels except the
    /// last.
    ///
    /// The result is bit-exact on every machine.
    ///
    /// # Errors
    /// [`RbnError::Invalid`] for an excess of functions in one place.
    pub fn new(
        functions: &Functions<'_>,
        direct_levels: usize,
        weights: ParentWeights,
    ) -> Result<Self, RbnError> {
        let &Functions { points, levels, .. } = functions;
        let lookup = Lookup::new(functions);
        let crowded = |most: usize| {
            RbnError::invalid("PNTS", format!("functions lie on top of each other, over {most} in one place"))
        };
        if (0..levels.len()).any(|l| lookup.fullest(l) > MOST_IN_A_BUCKET) {
            return Err(crowded(MOST_IN_A_BUCKET));
        }
        // The relations of overcrowded points would need unbounded time or memory.
        let mut tests = MOST_TESTED * points.len() + MANY;
        let most_entries = MOST_PARENTS * points.len() + MANY;
        let mut relations = Self { push_offsets: vec![0], lookup, ..Self::default() };
        let mut row = Vec::new();
        for (l, level) in levels.iter().enumerate() {
            for i in level.first as usize..(level.first + level.count) as usize {
                let tested = push_row(functions, &relations.lookup, (l, i), weights, &mut row);
                tests = tests.checked_sub(tested).ok_or_else(|| crowded(MOST_TESTED))?;
                pack_row(&row, &mut relations.push_entries);
                if relations.push_entries.len() > most_entries {
                    return Err(crowded(MOST_PARENTS));
                }
                relations.push_offsets.push(relations.push_entries.len() as u32);
            }
        }
        relations.add_children(
            functions.count_on(direct_levels.saturating_sub(1)),
            functions.count_on(direct_levels),
        );
        Ok(relations)
    }

    /// The push matrix.
    pub fn push(&self) -> Rows<'_> {
        Rows { offsets: &self.push_offsets, entries: &self.push_entries }
    }

    /// The pull matrix.
    pub fn pull(&self) -> Rows<'_> {
        Rows { offsets: &self.pull_offsets, entries: &self.pull_entries }
    }

    /// Adds the pull rows: the push rows transposed and [sharpened].
    fn add_children(&mut self, parents: usize, children: usize) {
        let mut next = vec![0u32; parents + 1];
        for entry in (0..children).flat_map(|j| self.push().row(j)) {
            next[entry.point() + 1] += 1;
        }
        for k in 0..parents {
            next[k + 1] += next[k];
        }
        let starts = next.clone();
        let mut shares = vec![(0u32, 0f32); starts[parents] as usize];
        for j in 0..children {
            for (parent, weight) in sharpened(self.push().row(j)) {
                let place = &mut next[parent];
                shares[*place as usize] = (j as u32, weight);
                *place += 1;
            }
        }
        self.pull_offsets.push(0);
        for range in starts.windows(2) {
            pack_row(&shares[range[0] as usize..range[1] as usize], &mut self.pull_entries);
            self.pull_offsets.push(self.pull_entries.len() as u32);
        }
    }
}

/// The parents of a point with their weights as a parent's children have them: the fourth power of a share, so that a point
/// averages the direct light around it and not beyond its neighbours. Plain shares would blur twice: in averaging and in
/// interpolation.
pub(super) fn sharpened(row: &[Entry]) -> impl Iterator<Item = (usize, f32)> + '_ {
    let total: f32 = row.iter().map(|e| e.weight()).sum();
    row.iter().map(move |entry| {
        let share = entry.weight() / total;
        (entry.point(), share * share * (share * share))
    })
}

/// Fills `row` with the parents of point `i` of a level and their weights. Returns the number of functions tested plus levels
/// visited.
pub(super) fn push_row(
    functions: &Functions<'_>,
    lookup: &Lookup,
    (level, i): (usize, usize),
    weights: ParentWeights,
    row: &mut Vec<(u32, f32)>,
) -> usize {
    let (points, p) = (functions.points, &functions.points[i]);
    let tested = parents(functions, lookup, level, i, row);
    if weights == ParentWeights::LeastSquares {
        make_linear(p.normal(), row, |k| points[k as usize].position() - p.position());
    }
    tested
}

/// Fills `row` with the functions of its group that cover point `i` on the finest covering level coarser than `level`, and
/// their weights. Leaves `row` empty for an uncovered point. Returns the number of functions tested plus levels visited.
#[inline(never)]
fn parents(
    functions: &Functions<'_>,
    lookup: &Lookup,
    level: usize,
    i: usize,
    row: &mut Vec<(u32, f32)>,
) -> usize {
    let &Functions { points, cuts, .. } = functions;
    let (position, normal, group) = (points[i].position(), points[i].normal(), functions.group_of(i));
    let mut tested = 0;
    for l in (0..level).rev() {
        row.clear();
        let mut total = 0.0;
        let entries = lookup.entries(l, position, group);
        tested += entries.len() + 1;
        for j in entries.iter().filter(|entry| entry.group() == group).map(|entry| entry.function()) {
            let q = &points[j as usize];
            let offset = position - q.position();
            // Rejects by distance before the normals are unpacked.
            if offset.length_squared() < q.radius * q.radius {
                let w = weight(offset, normal, q.normal(), q.radius);
                if w > 0.0 && !cuts[q.cuts()].iter().any(|cut| cut.ends(offset)) {
                    row.push((j, w));
                    total += w;
                }
            }
        }
        if total > LEAST_WEIGHT {
            return tested;
        }
    }
    row.clear();
    tested
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octahedral::pack_snorm16;
    use crate::rbn::bulk::Point;
    use crate::rbn::meta::Level;
    use glam::Vec3;

    /// Two levels of functions with spacing `apart` and a support radius of one unit.
    fn crowd(counts: [u32; 2], apart: f32) -> (Vec<Point>, Vec<Level>) {
        let point = |i: u32| Point {
            position: [apart * (i % 1000) as f32, 0.0, apart * (i / 1000) as f32],
            radius: 1.0,
            normal: pack_snorm16(Vec3::Y),
            ..Point::default()
        };
        let points = counts.iter().flat_map(|count| (0..*count).map(point)).collect();
        let level = |first, count| Level { first, count, ..Level::default() };
        (points, vec![level(0, counts[0]), level(counts[0], counts[1])])
    }

    fn functions<'a>(points: &'a [Point], levels: &'a [Level]) -> Functions<'a> {
        Functions { points, cuts: &[], levels, groups: &[] }
    }

    #[test]
    fn many_small_objects_in_one_place_are_no_crowd() {
        // A box of screws: a thousand groups with four functions each, in one cell of the coarse level's grid.
        let (points, levels) = crowd([4_000, 4_000], 1e-5);
        let groups: Vec<u32> = (0..8_000).map(|i| i / 4 % 1_000).collect();
        let functions = Functions { groups: &groups, ..functions(&points, &levels) };
        let relations = Relations::new(&functions, 2, ParentWeights::Shepard).unwrap();
        assert_eq!(relations.push_entries.len(), 4 * 4_000);
    }

    #[test]
    fn crowds_that_would_take_for_ever_are_refused() {
        for counts in [[2500, 2500], [2000, 200_000], [400, 400_000]] {
            let (points, levels) = crowd(counts, 1e-6);
            let refused = Relations::new(&functions(&points, &levels), 2, ParentWeights::Shepard)
                .unwrap_err()
                .to_string();
            assert!(refused.contains("on top of each other"), "{counts:?}: {refused}");
        }
        // Densities of real scenes are accepted; so are a few coincident points.
        let (points, levels) = crowd([16_000, 16_000], 0.5);
        let relations = Relations::new(&functions(&points, &levels), 2, ParentWeights::Shepard).unwrap();
        assert!(relations.push_entries.len() > 4 * 16_000);
        let (points, levels) = crowd([100, 100], 0.0);
        assert_eq!(
            Relations::new(&functions(&points, &levels), 2, ParentWeights::Shepard)
                .unwrap()
                .push_entries
                .len(),
            100 * 100
        );
    }
}
