//! Whether a vertex can go, and which neighbour takes its place.

use super::patch::MOST;
use super::patch::{COLOR, Look, NORMAL, Patch, UV};
use super::ring::{Ring, Side};
use glam::Vec3;
use smallvec::{SmallVec, smallvec};
use std::ops::ControlFlow;

/// A triangle is good enough whose height is this share of its longest side; others must not get worse.
const ROUND_ENOUGH: f32 = 0.005;
/// What is off by no more than this is as good as flat and even.
const EVEN: f32 = 0.02;
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
                    changed[vertex as usize] = pass;
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
    let sectors = match sectors(patch, vertex, ring) {
        Some(even) if even.iter().all(|sector| sector.error <= EVEN) => even,
        // Along a crease that hardly shows nothing of what is allowed is used up.
        Some(uneven) => creased(patch, vertex, ring, EVEN).unwrap_or(uneven),
        None => creased(patch, vertex, ring, 1.0)?,
    };
    // A vertex of two seams can only go along them.
    let neighbours = if ring.seams.is_empty() { &ring.ends[..] } else { &ring.seams };
    let least = sectors.iter().map(|sector| sector.roundness).fold(ROUND_ENOUGH, f32::min);
    let mut candidates: SmallVec<[(f32, u32); MOST]> =
        neighbours.iter().map(|to| (roundness_after(patch, ring, &sectors, *to), *to)).collect();
    candidates.retain(|candidate| candidate.0 > 0.0 && candidate.0 >= least);
    candidates.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let (to, after) = candidates.iter().find_map(|&(_, to)| {
        let after = corners_after(patch, vertex, ring, &sectors, to)?;
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
    patch.forget(vertex);
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
        let off = (high - low) / patch.tolerance;
        let before = sector.sides(ring).iter().map(|side| side.error).fold(0.0, f32::max);
        if before + off > 1.0 {
            return None;
        }
        // A fold may reach beyond what is around it.
        let roundness = ends().map(|[a, b]| roundness(Vec3::ZERO, a, b, normal)).fold(1.0, f32::min);
        if roundness <= 0.0 {
            return None;
        }
        (sector.normal, sector.roundness) = (normal, roundness);
        sector.error = before + off.max(bend(patch, sector.sides(ring), place, normal)?);
        (sector.error <= 1.0).then_some(sector)
    };
    ring.sectors.iter().map(sector).collect()
}

/// The sectors on both sides of a straight crease through the vertex, which then counts as two seams: there the surface
/// bends, or what it looks like changes in another way from there on. `None` where there is no such crease that leaves
/// both sides no farther than `most` from what they were.
fn creased(patch: &Patch, vertex: u32, ring: &mut Ring, most: f32) -> Option<Sectors<Sector>> {
    let count = ring.sides.len();
    if !ring.seams.is_empty() || ring.sectors[..] != [(0, count)] {
        return None;
    }
    let at = patch.positions[vertex as usize];
    let spokes: SmallVec<[Vec3; MOST]> =
        ring.sides.iter().map(|side| patch.positions[side.ends[0] as usize] - at).collect();
    let allowed = patch.tolerance * patch.tolerance;
    for (i, a) in spokes.iter().enumerate() {
        for (j, b) in spokes.iter().enumerate().skip(i + 2) {
            let is_straight =
                a.dot(*b) < 0.0 && a.cross(*b).length_squared() <= allowed * a.distance_squared(*b);
            if !is_straight {
                continue;
            }
            ring.sides.rotate_left(i);
            ring.seams.extend([ring.sides[0].ends[0], ring.sides[j - i].ends[0]]);
            ring.sectors = smallvec![(0, j - i), (j - i, count)];
            let found = sectors(patch, vertex, ring);
            if found.as_ref().is_some_and(|found| found.iter().all(|sector| sector.error <= most)) {
                return found;
            }
            ring.sides.rotate_right(i);
            ring.seams.clear();
            ring.sectors = smallvec![(0, count)];
        }
    }
    None
}

/// How far the looks around a vertex are from changing evenly, 1 being all that is allowed: what is between them, however
/// they are joined by triangles, differs by no more. `place` says where a vertex is from there.
fn bend(patch: &Patch, sides: &[Side], place: impl Fn(u32) -> Vec3, normal: Vec3) -> Option<f32> {
    let alike = sides.first()?.looks[0];
    if sides.iter().all(|side| side.looks == [alike; 3]) {
        return Some(0.0);
    }
    let look = |look: u32| &patch.looks[look as usize];
    // What the largest triangle says of the places beyond it.
    let area = |side: &Side| place(side.ends[0]).cross(place(side.ends[1])).dot(normal);
    let areas = sides.iter().map(|side| (area(side), side));
    let (most, largest) = areas.max_by(|p, q| p.0.total_cmp(&q.0))?;
    let ([a, b], scale) = (largest.ends.map(&place), 1.0 / most);
    let told = largest.looks.map(look);
    let last = sides.last()?;
    let ends = sides.iter().map(|side| (side.ends[0], side.looks[1])).chain([(last.ends[1], last.looks[2])]);
    let ends: SmallVec<[(&Look, f32, f32); MOST + 1]> = ends
        .map(|(end, k)| {
            let at = place(end);
            (look(k), at.cross(b).dot(normal) * scale, a.cross(at).dot(normal) * scale)
        })
        .collect();
    let off = rests(told, &ends, |look| look.normal).length() / NORMAL;
    let off = off.max(rests(told, &ends, |look| look.uv.extend(0.0)).max_element() / UV);
    Some(off.max(rests(told, &ends, |look| look.color).max_element() / COLOR))
}

/// The size of the box that the differences are in between what looks are and what a triangle's say at their places, each
/// told by the shares of its second and its third corner.
#[inline]
fn rests(told: [&Look; 3], looks: &[(&Look, f32, f32)], of: impl Fn(&Look) -> Vec3) -> Vec3 {
    let [first, second, third] = told.map(&of);
    if second == first && third == first && looks.iter().all(|look| of(look.0) == first) {
        return Vec3::ZERO;
    }
    let (mut low, mut high, mut sum) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    for (look, u, v) in looks {
        let rest = of(look) - (first + *u * (second - first) + *v * (third - first));
        (low, high, sum) = (low.min(rest), high.max(rest), sum + rest);
    }
    // What is not a number is not in any box.
    if sum.is_finite() { high - low } else { Vec3::INFINITY }
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
fn corners_after(
    patch: &Patch,
    vertex: u32,
    ring: &Ring,
    sectors: &[Sector],
    to: u32,
) -> Option<Sectors<(u32, f32)>> {
    // Between two seams' ends there is the vertex.
    let off = match ring.seams.iter().find(|other| **other != to) {
        None => 0.0,
        Some(&from) => {
            let [at, from, to] = [vertex, from, to].map(|v| patch.positions[v as usize]);
            let (a, along) = (from - at, to - from);
            let share = -a.dot(along) / along.length_squared();
            if !(share > 0.0 && share < 1.0) {
                return None;
            }
            (a + share * along).length() / patch.tolerance
        }
    };
    let after = |sector: &Sector| {
        let taken = sector.sides(ring).iter().find_map(|side| {
            let k = side.ends.iter().position(|end| *end == to)?;
            Some(side.looks[k + 1])
        })?;
        let error = sector.error + off;
        (error <= 1.0).then_some((taken, error))
    };
    sectors.iter().map(after).collect()
}

/// Whether no edge gets more triangles than it has, and the neighbour does not get too many.
fn stays_a_surface(patch: &mut Patch, ring: &Ring, to: u32) -> bool {
    let beside: SmallVec<[[u32; 2]; 4]> =
        ring.sides.iter().map(|side| side.ends).filter(|ends| ends.contains(&to)).collect();
    let is_far = |end: &u32| !beside.iter().any(|ends| ends.contains(end));
    let far: SmallVec<[u32; MOST]> = ring.ends.iter().copied().filter(is_far).collect();
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
