//! The triangles around a vertex, in order.

use super::patch::{MOST, Patch};
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// A triangle at the vertex, from one spoke to the next.
#[derive(Clone, Copy, Debug)]
pub struct Side {
    /// The vertex' corner of it.
    pub corner: u32,
    /// The other vertices, counter-clockwise.
    pub ends: [u32; 2],
    /// Looks at the vertex and at the ends.
    pub looks: [u32; 3],
    pub error: f32,
}

/// A vertex' triangles: sectors, each of them counter-clockwise, from one seam to another, or one all around.
///
/// A seam is an edge where looks change, or that another number of triangles than two have, or where they do not go on.
#[derive(Default)]
pub struct Ring {
    /// Sector by sector.
    pub sides: SmallVec<[Side; MOST]>,
    /// Where each sector begins among the sides, and one past its end.
    pub sectors: SmallVec<[(usize, usize); 4]>,
    /// The vertices across, once each.
    pub ends: SmallVec<[u32; MOST]>,
    /// Those across seams; three where there are more than two.
    pub seams: SmallVec<[u32; 4]>,
}

impl Ring {
    /// Finds the triangles of a vertex. `None` where they are too many, or where it must stay: where seams meet or one ends,
    /// or surfaces touch.
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
            // All around without seams, or there would be a second sector all around.
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
            // From a seam to the other one.
            if !seams.is_empty() && sides[end - 1].ends[1] == begin {
                return None;
            }
            sectors.push((first, end));
            first = end;
        }
        Some(())
    }

    /// Surfaces that meet at a vertex and share no edge there can go on without each other: one of them keeps the vertex, the
    /// others get a new one together. `None` where they are one surface. After [`Self::find`] has found seams that meet.
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

    /// The triangles of a vertex in any order; `None` where they are too many.
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

/// Whether the surface goes on across the edge to this vertex as if it were not there.
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
