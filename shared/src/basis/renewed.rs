//! Relations after a change of some functions' clip planes: the rows of [`Relations::new`], worked out where they change.

use super::relations::{ParentWeights, Relations, push_row, sharpened};
use super::{Functions, Lookup};
use crate::interpolation::{Entry, Rows, pack_row};
use crate::rbn::bulk::Point;
use crate::rbn::meta::Level;
use glam::Vec3;

/// Greatest numbers of entries of the push and of the pull matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MostEntries {
    /// Parents.
    pub push: usize,
    /// Children.
    pub pull: usize,
}

impl Relations {
    /// Returns the relations of functions whose clip planes differ from those `before`, whose relations these are, in the
    /// functions `changed`, ascending. `None` where they need more entries than `most`.
    pub fn renewed(
        &self,
        [before, functions]: [&Functions<'_>; 2],
        changed: &[u32],
        (direct_levels, weights): (usize, ParentWeights),
        most: MostEntries,
    ) -> Option<Self> {
        let rows = self.rows_of_children([before, functions], changed);
        let mut out = Self { lookup: self.lookup.clone(), ..Self::default() };
        // Parents whose children change.
        let mut is_parent = vec![false; functions.points.len()];
        let mut new_rows: Vec<(usize, Vec<Entry>)> = Vec::with_capacity(rows.len());
        let mut row = Vec::new();
        for (level, i) in rows {
            push_row(functions, &self.lookup, (level, i), weights, &mut row);
            let mut packed = Vec::new();
            pack_row(&row, &mut packed);
            let before = self.push().row(i);
            if packed != before {
                packed.iter().chain(before).for_each(|entry| is_parent[entry.point()] = true);
                new_rows.push((i, packed));
            }
        }
        (out.push_offsets, out.push_entries) = replaced(self.push(), &new_rows);
        let children = functions.count_on(direct_levels);
        let parents = functions.count_on(direct_levels.saturating_sub(1));
        let new_rows = out.children_of(functions, &is_parent[..parents], children);
        (out.pull_offsets, out.pull_entries) = replaced(self.pull(), &new_rows);
        (out.push_entries.len() <= most.push && out.pull_entries.len() <= most.pull).then_some(out)
    }

    /// Level and number of the points whose rows change: a function that covers the point, on a level from that of the parents
    /// up to the one above the point, is ended before it now and was not, or was and is not.
    fn rows_of_children(
        &self,
        [before, functions]: [&Functions<'_>; 2],
        changed: &[u32],
    ) -> Vec<(usize, usize)> {
        let &Functions { points, levels, .. } = functions;
        let mut is_changed = vec![false; points.len()];
        changed.iter().for_each(|i| is_changed[*i as usize] = true);
        let level_of = |i: usize| levels.partition_point(|level| (level.first as usize) <= i) - 1;
        // Boxes around the changed supports of each level.
        let of_level = |level: &Level| {
            let [first, end] = [level.first, level.first + level.count];
            let own = changed.iter().filter(move |i| (first..end).contains(*i));
            around(own.map(|i| &points[*i as usize]))
        };
        let boxes: Vec<[Vec3; 2]> = levels.iter().map(of_level).collect();
        let mut out = Vec::new();
        for (l, level) in levels.iter().enumerate().skip(1) {
            for i in level.first as usize..(level.first + level.count) as usize {
                let position = points[i].position();
                let is_near = |at: &usize| {
                    let [low, high] = boxes[*at];
                    position.cmpge(low).all() && position.cmple(high).all()
                };
                if !(0..l).any(|at| is_near(&at)) {
                    continue;
                }
                let coarsest = self.push().row(i).first().map_or(0, |entry| level_of(entry.point()));
                let is_parted = |function: usize| {
                    let offset = position - points[function].position();
                    let is_ended = |of: &Functions<'_>| {
                        of.cuts[of.points[function].cuts()].iter().any(|cut| cut.ends(offset))
                    };
                    is_changed[function] && is_ended(before) != is_ended(functions)
                };
                let is_covered = |at: usize| covers(&self.lookup, functions, at, i, is_parted);
                if (coarsest..l).filter(is_near).any(is_covered) {
                    out.push((l, i));
                }
            }
        }
        out
    }

    /// The children of some points, among the first `children` points.
    fn children_of(
        &self,
        functions: &Functions<'_>,
        is_parent: &[bool],
        children: usize,
    ) -> Vec<(usize, Vec<Entry>)> {
        let mut found: Vec<(usize, u32, f32)> = Vec::new();
        let is_wanted = |parent: usize| is_parent.get(parent) == Some(&true);
        let parents = functions.points.iter().zip(is_parent).filter(|(_, is_parent)| **is_parent);
        let [low, high] = around(parents.map(|(point, _)| point));
        let is_near = |j: &usize| {
            let position = functions.points[*j].position();
            position.cmpge(low).all() && position.cmple(high).all()
        };
        for j in (0..children).filter(is_near) {
            let row = self.push().row(j);
            if row.iter().any(|entry| is_wanted(entry.point())) {
                let own = sharpened(row).filter(|(parent, _)| is_wanted(*parent));
                found.extend(own.map(|(parent, weight)| (parent, j as u32, weight)));
            }
        }
        found.sort_by_key(|(parent, child, _)| (*parent, *child));
        let mut parts = found.chunk_by(|a, b| a.0 == b.0).peekable();
        let of = |parent: usize| {
            let own = parts.next_if(|part| part[0].0 == parent).unwrap_or_default();
            let row: Vec<(u32, f32)> = own.iter().map(|(_, child, weight)| (*child, *weight)).collect();
            let mut packed = Vec::new();
            pack_row(&row, &mut packed);
            (parent, packed)
        };
        (0..is_parent.len()).filter(|parent| is_parent[*parent]).map(of).collect()
    }
}

/// Box around the supports of points.
fn around<'a>(points: impl Iterator<Item = &'a Point>) -> [Vec3; 2] {
    points.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[low, high], point| {
        let position = point.position();
        [low.min(position - point.radius), high.max(position + point.radius)]
    })
}

/// Whether a function of a level that `is_wanted` may cover point `i`, as far as planes are left out of account.
fn covers(
    lookup: &Lookup,
    functions: &Functions<'_>,
    level: usize,
    i: usize,
    is_wanted: impl Fn(usize) -> bool,
) -> bool {
    let (position, group) = (functions.points[i].position(), functions.group_of(i));
    lookup.entries(level, position, group).iter().any(|entry| {
        let j = entry.function() as usize;
        let q = &functions.points[j];
        entry.group() == group
            && (position - q.position()).length_squared() < q.radius * q.radius
            && is_wanted(j)
    })
}

/// Returns a matrix with some rows, ascending, in place of its own.
fn replaced(Rows { offsets, entries }: Rows<'_>, rows: &[(usize, Vec<Entry>)]) -> (Vec<u32>, Vec<Entry>) {
    let mut out = (Vec::with_capacity(offsets.len()), Vec::with_capacity(entries.len()));
    let mut next = 0;
    // Copies the rows up to one.
    let keep = |to: usize, next: &mut usize, out: &mut (Vec<u32>, Vec<Entry>)| {
        let first = out.1.len() as u32;
        out.0.extend(offsets[*next..to].iter().map(|at| first + (at - offsets[*next])));
        out.1.extend_from_slice(&entries[offsets[*next] as usize..offsets[to] as usize]);
        *next = to;
    };
    for (i, row) in rows {
        keep(*i, &mut next, &mut out);
        out.0.push(out.1.len() as u32);
        out.1.extend_from_slice(row);
        next = i + 1;
    }
    keep(offsets.len().saturating_sub(1), &mut next, &mut out);
    out.0.push(out.1.len() as u32);
    out
}
