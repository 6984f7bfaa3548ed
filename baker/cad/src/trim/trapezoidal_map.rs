//! Trapezoidal map: point location among trimming curves.

mod area;

use super::crossing::crossings;
use super::piece::{MonotoneEdge, Vertical, cut};
use super::{TrimEdge, TrimLoop};
use glam::DVec2;
use std::f64::consts::TAU;

/// Ends farther apart than this part of the bounds' larger side leave a loop open; closer, a segment joins them.
const CLOSURE_TOLERANCE: f64 = 1e-4;
/// What lies no farther than this part of the bounds' larger side inside the rim of a patch does not count as inside.
const RIM_TOLERANCE: f64 = 1e-12;
/// The same part of a patch, where the question is whether a domain is all of it.
const WHOLE_TOLERANCE: f64 = 1e-9;
/// Entries of lists a piece, on average, below which slabs have lists of their own.
const ENTRIES_PER_PIECE: usize = 8;

/// What is wrong with the loops of a domain.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TrimError {
    /// No loop, or a loop without edges.
    #[error("a trimmed domain has no edges")]
    NoEdges,
    /// All edges have no length.
    #[error("all edges of a trimmed domain have no length")]
    NoExtent,
    /// A coordinate, radius or angle is no finite number.
    #[error("edge {edge} of trimming loop {curve} is not finite")]
    NotFinite {
        /// Index of the loop.
        curve: usize,
        /// Index of the edge.
        edge: usize,
    },
    /// A radius is 0 or less, or the angles are more than 2π apart.
    #[error("edge {edge} of trimming loop {curve} is no arc: radii {radii}, angles {angles:?}")]
    BadArc {
        /// Index of the loop.
        curve: usize,
        /// Index of the edge.
        edge: usize,
        /// Radii.
        radii: DVec2,
        /// Angles, radians.
        angles: [f64; 2],
    },
    /// An edge does not begin where the one before it ends.
    #[error("trimming loop {curve} is open by {gap} before edge {edge}")]
    Open {
        /// Index of the loop.
        curve: usize,
        /// Index of the edge after the gap.
        edge: usize,
        /// Distance in the parameter plane.
        gap: f64,
    },
}

/// How a patch of the parameter plane lies to a domain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coverage {
    /// No part of it is in the domain.
    Empty,
    /// All of it is in the domain.
    Plain,
    /// The boundary may pass through it.
    Boundary,
}

/// Which points of the parameter plane are in a trimmed domain: the trapezoidal map of Boissonnat and Yvinec (Algorithmic
/// Geometry, 1998), with curved arcs as in the virtual mesh of Alonso et al. (2001), 4.2.
///
/// Vertical lines through the ends of pieces monotonic in u and v, and through their crossings, divide the plane into slabs.
/// Within a slab no pieces cross, so that they are sorted by v, and a point is in the domain where the number of pieces below
/// it is odd.
///
/// Lists of all slabs take O(n²) entries where many pieces are long. A piece that spans many slabs is in the lists of
/// O(log n) nodes of a segment tree over the slabs instead (de Berg et al., Computational Geometry, 10.3); numbers of pieces
/// below add up from the slab to the root. Upper levels are pushed down into their children while there are no more than 8
/// entries a piece: most domains are left with one level, plain slabs. For n pieces and crossings, memory is O(n log n), a
/// query O(log n) on one level and O(log² n) at most. Building takes O(n log n), and a test for crossings of each pair of pieces
/// whose extents in u overlap, O(n²) at most.
#[derive(Clone, Debug)]
pub struct TrapezoidalMap {
    bounds: [DVec2; 2],
    pieces: Vec<MonotoneEdge>,
    verticals: Vec<Vertical>,
    /// Lines between slabs, ascending.
    lines: Vec<f64>,
    levels: Vec<Level>,
}

/// Nodes of one level of the segment tree.
#[derive(Clone, Debug)]
struct Level {
    /// log₂ of the slabs a node spans.
    shift: u32,
    /// Node i has the entries from `begins[i]` to `begins[i + 1]`.
    begins: Vec<u32>,
    /// Indices of pieces that span the node, by v.
    entries: Vec<u32>,
}

impl Level {
    fn node(&self, slab: usize) -> &[u32] {
        let node = slab >> self.shift;
        &self.entries[self.begins[node] as usize..self.begins[node + 1] as usize]
    }
}

impl TrapezoidalMap {
    /// The map of closed curves, in any order and direction. They may cross, touch and overlap.
    ///
    /// # Errors
    /// If there is no edge with a length, an edge is no finite curve, or a loop is open.
    pub fn new(loops: &[TrimLoop]) -> Result<Self, TrimError> {
        let edges = checked(loops)?;
        let mut pieces = Vec::new();
        let mut verticals = Vec::new();
        for edge in &edges {
            cut(edge, &mut pieces, &mut verticals);
        }
        let mut bounds = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        let spans = pieces.iter().map(|p| (p.u, p.v_range()));
        for (u, v) in spans.chain(verticals.iter().map(|e| ([e.u; 2], e.v))) {
            bounds[0] = bounds[0].min(DVec2::new(u[0], v[0]));
            bounds[1] = bounds[1].max(DVec2::new(u[1], v[1]));
        }
        if pieces.is_empty() && verticals.is_empty() {
            return Err(TrimError::NoExtent);
        }
        pieces.sort_by(|a, b| a.u[0].total_cmp(&b.u[0]));
        verticals.sort_by(|a, b| a.u.total_cmp(&b.u));
        let cuts = cuts(&pieces, 1e-14 * (bounds[1] - bounds[0]).max_element());
        let ends = pieces.iter().flat_map(|p| p.u);
        let mut lines: Vec<f64> = ends.chain(cuts.iter().map(|&(_, u)| u)).collect();
        lines.sort_by(f64::total_cmp);
        lines.dedup();
        let levels = levels(&pieces, &cuts, &lines);
        Ok(Self { bounds, pieces, verticals, lines, levels })
    }

    /// Whether a point is in the domain. Of a point on the boundary, it is what lies just above it in v, or, on a vertical
    /// segment, to the right in u: of two domains on both sides of an edge, exactly one has it.
    pub fn contains(&self, at: DVec2) -> bool {
        let slab = self.lines.partition_point(|&line| line <= at.x);
        if slab == 0 || slab == self.lines.len() {
            return false;
        }
        let below = |level: &Level| {
            level.node(slab - 1).partition_point(|&entry| self.pieces[entry as usize].v_at(at.x) <= at.y)
        };
        self.levels.iter().map(below).sum::<usize>() % 2 == 1
    }

    /// Least and greatest u and v of the boundary.
    pub fn bounds(&self) -> [DVec2; 2] {
        self.bounds
    }

    /// Whether the domain is all of a patch between two corners, but for 10⁻⁹ of its size along the rim.
    pub fn is_all_of(&self, patch: [DVec2; 2]) -> bool {
        let margin = WHOLE_TOLERANCE * (patch[1] - patch[0]);
        self.coverage([patch[0] + margin, patch[1] - margin]) == Coverage::Plain
    }

    /// Whether a part of a patch between two corners may be in the domain; false if surely none is.
    pub fn meets(&self, patch: [DVec2; 2]) -> bool {
        self.coverage(patch) != Coverage::Empty
    }

    /// How a patch from the least to the greatest u and v lies to the domain. A boundary that only touches the patch from
    /// outside, within 10⁻¹² of the bounds' size, does not count. A patch that is narrower than that, or no rectangle, is
    /// [`Coverage::Boundary`].
    ///
    /// O((s + log n) log n) at most where the patch spans s slabs; less where the boundary passes through it.
    pub fn coverage(&self, patch: [DVec2; 2]) -> Coverage {
        let margin = DVec2::splat(RIM_TOLERANCE * (self.bounds[1] - self.bounds[0]).max_element());
        let (low, high) = (patch[0] + margin, patch[1] - margin);
        if !(low.x <= high.x && low.y <= high.y) || self.has_boundary_in(low, high) {
            Coverage::Boundary
        } else if self.contains(low.midpoint(high)) {
            Coverage::Plain
        } else {
            Coverage::Empty
        }
    }

    /// Whether a piece meets a closed rectangle.
    fn has_boundary_in(&self, low: DVec2, high: DVec2) -> bool {
        let first = self.verticals.partition_point(|edge| edge.u < low.x);
        let mut within = self.verticals[first..].iter().take_while(|edge| edge.u <= high.x);
        if within.any(|edge| edge.v[0] <= high.y && edge.v[1] >= low.y) {
            return true;
        }
        let slabs = self.lines.len().saturating_sub(1);
        let begin = self.lines.partition_point(|&line| line < low.x).saturating_sub(1);
        let end = self.lines.partition_point(|&line| line <= high.x).min(slabs);
        self.levels.iter().any(|level| {
            let mut slab = begin;
            while slab < end {
                let after = ((slab >> level.shift) + 1) << level.shift;
                let node = (slab >> level.shift) << level.shift;
                // Where the node meets the rectangle; its pieces span it and are in the same order all along.
                let left = self.lines[node].max(low.x);
                let right = self.lines[after.min(slabs)].min(high.x);
                if left <= right {
                    let entries = level.node(slab);
                    let ends = |entry: u32| {
                        let piece = &self.pieces[entry as usize];
                        [piece.v_at(left), piece.v_at(right)]
                    };
                    let above = entries.partition_point(|&entry| {
                        let [a, b] = ends(entry);
                        a.max(b) < low.y
                    });
                    if entries.get(above).is_some_and(|&entry| {
                        let [a, b] = ends(entry);
                        a.min(b) <= high.y
                    }) {
                        return true;
                    }
                }
                slab = after;
            }
            false
        })
    }

    /// Entries of all lists.
    #[cfg(test)]
    pub(super) fn entries(&self) -> usize {
        self.levels.iter().map(|level| level.entries.len()).sum()
    }

    /// Pieces and levels.
    #[cfg(test)]
    pub(super) fn counts(&self) -> [usize; 2] {
        [self.pieces.len(), self.levels.len()]
    }
}

/// The edges that have a length, and segments that close gaps.
fn checked(loops: &[TrimLoop]) -> Result<Vec<TrimEdge>, TrimError> {
    if loops.is_empty() || loops.iter().any(Vec::is_empty) {
        return Err(TrimError::NoEdges);
    }
    let mut bounds = [DVec2::INFINITY, DVec2::NEG_INFINITY];
    for (curve, edges) in loops.iter().enumerate() {
        for (edge, it) in edges.iter().enumerate() {
            let [a, b] = it.ends();
            if !(a.is_finite() && b.is_finite()) {
                return Err(TrimError::NotFinite { curve, edge });
            }
            (bounds[0], bounds[1]) = (bounds[0].min(a).min(b), bounds[1].max(a).max(b));
            if let TrimEdge::Arc { centre, radii, angles } = *it {
                if !(centre.is_finite() && radii.is_finite() && angles.iter().all(|t| t.is_finite())) {
                    return Err(TrimError::NotFinite { curve, edge });
                }
                if radii.min_element() <= 0.0 || (angles[1] - angles[0]).abs() > TAU + 1e-9 {
                    return Err(TrimError::BadArc { curve, edge, radii, angles });
                }
                let middle = it.at(0.5);
                (bounds[0], bounds[1]) = (bounds[0].min(middle), bounds[1].max(middle));
            }
        }
    }
    let tolerance = CLOSURE_TOLERANCE * (bounds[1] - bounds[0]).max_element();
    let mut checked = Vec::new();
    for (curve, edges) in loops.iter().enumerate() {
        for (edge, it) in edges.iter().enumerate() {
            let before = if edge == 0 { &edges[edges.len() - 1] } else { &edges[edge - 1] };
            let (end, [begin, _]) = (before.ends()[1], it.ends());
            let gap = end.distance(begin);
            if gap > tolerance || !gap.is_finite() {
                return Err(TrimError::Open { curve, edge, gap });
            }
            if gap > 0.0 {
                checked.push(TrimEdge::Segment { from: end, to: begin });
            }
            checked.push(*it);
        }
    }
    Ok(checked)
}

/// Pieces, and where others cross them, in the order of pieces and u.
fn cuts(pieces: &[MonotoneEdge], tolerance: f64) -> Vec<(usize, f64)> {
    let mut cuts = Vec::new();
    let mut found = Vec::new();
    let mut active: Vec<usize> = Vec::new();
    for (i, piece) in pieces.iter().enumerate() {
        active.retain(|&other| pieces[other].u[1] > piece.u[0]);
        let [low, high] = piece.v_range();
        for &other in &active {
            let [other_low, other_high] = pieces[other].v_range();
            if other_low <= high && other_high >= low {
                crossings(piece, &pieces[other], tolerance, &mut found);
                cuts.extend(found.drain(..).flat_map(|u| [(i, u), (other, u)]));
            }
        }
        active.push(i);
    }
    cuts.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    cuts
}

/// Grows with v among pieces that do not cross between a and b, also if they touch there.
fn sort_key(piece: &MonotoneEdge, a: f64, b: f64) -> f64 {
    [0.25, 0.5, 0.75].map(|t| piece.v_at(a + (b - a) * t)).iter().sum()
}

/// The segment tree's lists: see [`TrapezoidalMap`].
fn levels(pieces: &[MonotoneEdge], cuts: &[(usize, f64)], lines: &[f64]) -> Vec<Level> {
    let slabs = lines.len().saturating_sub(1);
    // Lists by level, of nodes and pieces.
    let mut lists: Vec<Vec<(usize, u32)>> = Vec::new();
    let mut next_cut = 0;
    for (index, piece) in pieces.iter().enumerate() {
        let mut begin = piece.u[0];
        loop {
            let cut = cuts.get(next_cut).filter(|cut| cut.0 == index);
            next_cut += usize::from(cut.is_some());
            let end = cut.map_or(piece.u[1], |cut| cut.1);
            let at = |u: f64| lines.partition_point(|&line| line < u);
            let (mut a, mut b, mut level) = (at(begin), at(end), 0);
            while a < b {
                if lists.len() == level {
                    lists.push(Vec::new());
                }
                if a % 2 == 1 {
                    lists[level].push((a, index as u32));
                    a += 1;
                }
                if b % 2 == 1 {
                    b -= 1;
                    lists[level].push((b, index as u32));
                }
                (a, b, level) = (a / 2, b / 2, level + 1);
            }
            begin = end;
            if cut.is_none() {
                break;
            }
        }
    }
    let mut entries: usize = lists.iter().map(Vec::len).sum();
    for level in (1..lists.len()).rev() {
        if entries + lists[level].len() <= ENTRIES_PER_PIECE * (pieces.len() + cuts.len()) {
            let upper = std::mem::take(&mut lists[level]);
            entries += upper.len();
            lists[level - 1].extend(upper.iter().flat_map(|&(node, p)| [(2 * node, p), (2 * node + 1, p)]));
        }
    }
    let sorted = |(shift, list): (usize, Vec<(usize, u32)>)| {
        let nodes = slabs.div_ceil(1 << shift);
        let key = |node: usize, piece: u32| {
            let (a, b) = (node << shift, ((node + 1) << shift).min(slabs));
            sort_key(&pieces[piece as usize], lines[a], lines[b])
        };
        let mut list: Vec<(usize, f64, u32)> = list.into_iter().map(|(n, p)| (n, key(n, p), p)).collect();
        list.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let begins = (0..=nodes).map(|node| list.partition_point(|entry| entry.0 < node) as u32).collect();
        Level { shift: shift as u32, begins, entries: list.into_iter().map(|entry| entry.2).collect() }
    };
    lists.into_iter().enumerate().filter(|(_, list)| !list.is_empty()).map(sorted).collect()
}
