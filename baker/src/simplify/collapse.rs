//! Whether a vertex can go, and which neighbour takes its place.

use super::patch::{Look, Patch};
use super::ring::{MOST, Ring, Side};
use glam::Vec3;
use smallvec::SmallVec;
use std::ops::ControlFlow;

/// A triangle is good enough whose height is this share of its longest side; others must not get worse.
const ROUND_ENOUGH: f32 = 0.005;
/// Passes over the vertices at most.
const PASSES: u32 = 40;

/// Something for each sector: few have more than two.
type Sectors<T> = SmallVec<[T; 2]>;

/// The triangles at a vertex between two seams.
struct Sector {
    /// Where its sides begin in the ring, and one past their end.
    range: (usize, usize),
    /// Unit normal.
    normal: Vec3,
    /// How far the triangles are from what they were once some neighbour took the vertex' place.
    error: f32,
    /// The least of the triangles.
    roundness: f32,
}

impl Sector {
    /// Its sides, counter-clockwise.
    #[inline]
    fn sides<'a>(&self, ring: &'a Ring) -> &'a [Side] {
        &ring.sides[self.range.0..self.range.1]
    }
}

/// Takes out the vertices that the surface does not need. Those next to one that was taken out wait for the next pass, so
/// that all places get coarser alike.
pub fn collapse_all(patch: &mut Patch) {
    let is_free = |patch: &Patch, vertex: u32| !patch.is_fixed[vertex as usize];
    let mut waiting: Vec<u32> = (0..patch.positions.len() as u32).filter(|v| is_free(patch, *v)).collect();
    let mut next = Vec::new();
    // The last pass in which something changed next to a vertex.
    let mut changed = vec![0; patch.positions.len()];
    let mut ring = Ring::default();
    for pass in 1..=PASSES {
        for vertex in waiting.drain(..) {
            if changed[vertex as usize] == pass {
                continue;
            }
            if collapse(patch, vertex, &mut ring).is_none() {
                // Where seams meet, surfaces may only touch.
                if ring.seams.len() > 2
                    && let Some(new) = ring.part(patch, vertex)
                {
                    changed.push(pass);
                    next.extend([vertex, new]);
                }
                continue;
            }
            for &end in &ring.ends {
                if std::mem::replace(&mut changed[end as usize], pass) != pass && is_free(patch, end) {
                    next.push(end);
                }
            }
        }
        std::mem::swap(&mut waiting, &mut next);
        if waiting.is_empty() {
            break;
        }
    }
}

/// Takes a vertex out, if there is a neighbour that can be in its place in all of its triangles.
fn collapse(patch: &mut Patch, vertex: u32, ring: &mut Ring) -> Option<()> {
    ring.find(patch, vertex)?;
    let sectors = sectors(patch, vertex, ring)?;
    // A vertex of two seams can only go along them.
    let neighbours = if ring.seams.is_empty() { &ring.ends[..] } else { &ring.seams };
    let least = sectors.iter().map(|sector| sector.roundness).fold(ROUND_ENOUGH, f32::min);
    let mut candidates: SmallVec<[(f32, u32); MOST]> =
        neighbours.iter().map(|to| (roundness_after(patch, ring, &sectors, *to), *to)).collect();
    candidates.retain(|candidate| candidate.0 > 0.0 && candidate.0 >= least);
    candidates.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let (to, after) = candidates.iter().find_map(|&(_, to)| {
        let after = looks_after(patch, vertex, ring, &sectors, to)?;
        stays_a_surface(patch, ring, to).then_some((to, after))
    })?;
    for (sector, &(look, error)) in sectors.iter().zip(&after) {
        for side in sector.sides(ring) {
            let triangle = &mut patch.triangles[side.corner as usize / 3];
            if side.ends.contains(&to) {
                triangle.is_gone = true;
                continue;
            }
            triangle.vertices[side.corner as usize % 3] = to;
            triangle.looks[side.corner as usize % 3] = look;
            triangle.error = error;
            patch.link(side.corner, to);
        }
    }
    Some(())
}

/// The sectors of a ring; `None` where the vertex must stay, whichever neighbour would take its place.
fn sectors(patch: &Patch, vertex: u32, ring: &Ring) -> Option<Sectors<Sector>> {
    let at = patch.positions[vertex as usize];
    let place = |v: u32| patch.positions[v as usize] - at;
    let sector = |range: &(usize, usize)| {
        let mut sector = Sector { range: *range, normal: Vec3::ZERO, error: 0.0, roundness: 1.0 };
        let ends = || sector.sides(ring).iter().map(|side| side.ends.map(place));
        let normal = ends().map(|[a, b]| a.cross(b)).sum::<Vec3>().try_normalize()?;
        let (mut low, mut high) = (0f32, 0f32);
        for height in ends().flatten().map(|end| end.dot(normal)) {
            (low, high) = (low.min(height), high.max(height));
        }
        let before = sector.sides(ring).iter().map(|side| side.error).fold(0.0, f32::max);
        let error = before + (high - low) / patch.tolerance;
        if error > 1.0 {
            return None;
        }
        // A fold may reach beyond what is around it.
        let roundness = ends().map(|[a, b]| roundness(Vec3::ZERO, a, b, normal)).fold(1.0, f32::min);
        if roundness <= 0.0 {
            return None;
        }
        (sector.normal, sector.error, sector.roundness) = (normal, error, roundness);
        Some(sector)
    };
    ring.sectors.iter().map(sector).collect()
}

/// A triangle's height over its longest side, seen along a normal: negative from behind.
fn roundness(a: Vec3, b: Vec3, c: Vec3, normal: Vec3) -> f32 {
    let (ab, ac) = (b - a, c - a);
    let longest = ab.length_squared().max(ac.length_squared()).max(b.distance_squared(c));
    ab.cross(ac).dot(normal) / longest
}

/// The least roundness of the triangles that are left with this neighbour in the vertex' place; 0 where a sector loses all.
fn roundness_after(patch: &Patch, ring: &Ring, sectors: &[Sector], to: u32) -> f32 {
    let place = |v: u32| patch.positions[v as usize];
    let of = |sector: &Sector| {
        let sides = sector.sides(ring).iter().map(|side| side.ends).filter(|ends| !ends.contains(&to));
        sides.map(|[a, b]| roundness(place(to), place(a), place(b), sector.normal)).reduce(f32::min)
    };
    sectors.iter().map(|sector| of(sector).unwrap_or(0.0)).fold(1.0, f32::min)
}

/// What each sector's triangles look like at the corner that takes the vertex' place, and how far they are then from what
/// they were; `None` where that is too far.
fn looks_after(
    patch: &Patch,
    vertex: u32,
    ring: &Ring,
    sectors: &[Sector],
    to: u32,
) -> Option<Sectors<(u32, f32)>> {
    let at = patch.positions[vertex as usize];
    let place = |v: u32| patch.positions[v as usize] - at;
    let look = |look: u32| patch.looks[look as usize];
    // Between two seams' ends there is the vertex.
    let line = match ring.seams.iter().find(|other| **other != to) {
        None => None,
        Some(&from) => {
            let (a, b) = (place(from), place(to));
            let along = b - a;
            let share = -a.dot(along) / along.length_squared();
            if !(share > 0.0 && share < 1.0) {
                return None;
            }
            Some((from, share, (a + share * along).length() / patch.tolerance))
        }
    };
    let after = |sector: &Sector| {
        let at_end = |end: u32| {
            sector.sides(ring).iter().find_map(|side| {
                let k = side.ends.iter().position(|other| *other == end)?;
                Some(side.looks[k + 1])
            })
        };
        let before = look(sector.sides(ring)[0].looks[0]);
        let taken = at_end(to)?;
        let (mixed, off) = match line {
            Some((from, share, off)) => {
                (Look::mix([look(at_end(from)?), look(taken)], [1.0 - share, share]), off)
            }
            None => {
                // The triangle that will be where the vertex was.
                let around = |side: &Side| {
                    let [a, b, v] = [place(side.ends[0]), place(side.ends[1]), place(to)];
                    [a.cross(b), b.cross(v), v.cross(a)].map(|area| area.dot(sector.normal))
                };
                let left = sector
                    .sides(ring)
                    .iter()
                    .filter(|side| !side.ends.contains(&to))
                    .map(|side| (side, around(side)));
                let (side, areas) =
                    left.max_by(|(_, p), (_, q)| p[1].min(p[2]).total_cmp(&q[1].min(q[2])))?;
                let total: f32 = areas.iter().sum();
                let looks = [taken, side.looks[1], side.looks[2]].map(look);
                (Look::mix(looks, areas.map(|area| area / total)), 0.0)
            }
        };
        let error = sector.error + off.max(before.distance(&mixed));
        (error <= 1.0).then_some((taken, error))
    };
    sectors.iter().map(after).collect()
}

/// Whether no edge gets more triangles than it has, and the neighbour does not get too many.
fn stays_a_surface(patch: &mut Patch, ring: &Ring, to: u32) -> bool {
    let beside = |end: u32| ring.sides.iter().any(|side| side.ends == [end, to] || side.ends == [to, end]);
    let far: SmallVec<[u32; MOST]> =
        ring.ends.iter().copied().filter(|end| *end != to && !beside(*end)).collect();
    // Both have the triangles between them, which go.
    let mut count = 0;
    let visited = patch.corners(to, |_, triangle| {
        count += 1;
        let is_joined = triangle.vertices.iter().any(|vertex| far.contains(vertex));
        match is_joined || count + ring.sides.len() > MOST + 4 {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    });
    visited.is_continue()
}
