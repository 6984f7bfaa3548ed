//! The triangles around a vertex, in order.

use super::patch::{MOST, Patch};
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// Triangle at the vertex, between two successive spokes.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The triangle's corner at the vertex.
    pub corner: u32,
    /// The two opposite vertices, counter-clockwise.
    pub ends: [u32; 2],
    /// Looks at the vertex and at the ends.
    pub looks: [u32; 3],
    pub error: f32,
}

/// Triangles of a vertex, as sectors: counter-clockwise fans from a seam to the next seam, or a closed fan.
///
/// A seam is an edge with a change of looks, with a number of triangles other than two, or with triangles of
/// inconsistent orientation.
#[derive(Default)]
pub struct Ring {
    /// Sector by sector.
    pub sides: SmallVec<[Side; MOST]>,
    /// By sector: first side, and one past the last side.
    pub sectors: SmallVec<[(usize, usize); 4]>,
    /// Opposite vertices, without duplicates.
    pub ends: SmallVec<[u32; MOST]>,
    /// Opposite vertices at seams; three for more than two seams.
    pub seams: SmallVec<[u32; 4]>,
}

impl Ring {
    /// Finds the triangles of a vertex. `None` for more than [`MOST`] triangles, or if the vertex must stay: seams
    /// meet, a seam ends, or surfaces touch.
    pub fn find(&mut self, patch: &mut Patch, vertex: u32) -> Option<()> {
        self.seams.clear();
        self.gather(patch, vertex)?;
        let Self { sides, sectors, ends, seams } = self;
        ends.clear();
        for end in sides.iter().flat_map(|side| side.ends) {
            if ends.contains(&end) {
                continue;
            }
            ends.push(end);
            if !goes_on(sides, end) {
                seams.push(end);
                if seams.len() > 2 {
                    return None;
                }
            }
        }
        sectors.clear();
        let mut first = 0;
        while first < sides.len() {
            let begins = |side: &Side| seams.is_empty() || seams.contains(&side.ends[0]);
            // Without seams, a closed fan; a second closed fan is rejected.
            let start = (first..sides.len())
                .find(|i| begins(&sides[*i]))
                .filter(|_| !seams.is_empty() || first == 0)?;
            sides.swap(first, start);
            let mut end = first + 1;
            let begin = sides[first].ends[0];
            while sides[end - 1].ends[1] != begin && !seams.contains(&sides[end - 1].ends[1]) {
                let next = (end..sides.len()).find(|i| sides[*i].ends[0] == sides[end - 1].ends[1])?;
                sides.swap(end, next);
                end += 1;
            }
            // A sector ends at the opposite seam.
            if !seams.is_empty() && sides[end - 1].ends[1] == begin {
                return None;
            }
            sectors.push((first, end));
            first = end;
        }
        Some(())
    }

    /// Separates surfaces that meet at a vertex without a common edge: a surface keeps the vertex, the remaining
    /// surfaces share a new vertex. Returns the new vertex; `None` for a single surface. Requires a preceding
    /// [`Self::find`] with meeting seams.
    pub fn part(&mut self, patch: &mut Patch, vertex: u32) -> Option<u32> {
        let sides = &mut self.sides;
        let (mut end, mut looked_at) = (sides.len().min(1), 0);
        while looked_at < end {
            let ends = sides[looked_at].ends;
            let mut i = end;
            while i < sides.len() {
                if sides[i].ends.iter().any(|vertex| ends.contains(vertex)) {
                    sides.swap(i, end);
                    end += 1;
                }
                i += 1;
            }
            looked_at += 1;
        }
        let others: SmallVec<[u32; MOST]> = sides[end..].iter().map(|side| side.corner).collect();
        (!others.is_empty()).then(|| patch.part(vertex, &others))
    }

    /// Collects the triangles of a vertex, in no particular order; `None` for more than [`MOST`] triangles.
    fn gather(&mut self, patch: &mut Patch, vertex: u32) -> Option<()> {
        let sides = &mut self.sides;
        sides.clear();
        let visited = patch.corners(vertex, |corner, triangle| {
            if sides.len() == MOST {
                return ControlFlow::Break(());
            }
            let at = corner as usize % 3;
            let [after, last] = [(at + 1) % 3, (at + 2) % 3];
            let ends = [triangle.vertices[after], triangle.vertices[last]];
            let looks = [at, after, last].map(|k| triangle.looks[k]);
            sides.push(Side { corner, ends, looks, error: triangle.error });
            ControlFlow::Continue(())
        });
        visited.is_continue().then_some(())
    }
}

/// Returns whether the surface is continuous across the edge to `end`: two triangles with equal looks and orientation.
#[inline]
fn goes_on(sides: &[Side], end: u32) -> bool {
    let (mut before, mut after) = (None, None);
    for side in sides {
        for (known, looks) in [(&mut after, [0, 1]), (&mut before, [0, 2])] {
            if side.ends[looks[1] - 1] == end && known.replace(looks.map(|k| side.looks[k])).is_some() {
                return false;
            }
        }
    }
    before.is_some() && before == after
}
