//! Vertex removal: whether a vertex can be removed, and the neighbour as its replacement.

use super::patch::MOST;
use super::patch::{COLOR, CornerAttributes, NORMAL, Patch, UV};
use super::ring::{Ring, Side};
use glam::Vec3;
use smallvec::{SmallVec, smallvec};
use std::ops::ControlFlow;

/// Sufficient roundness (height over longest side) of a triangle; a lower roundness must not decrease.
const ROUND_ENOUGH: f32 = 0.005;
/// Maximum deviation of a surface that counts as flat with linear looks, as a fraction of the limit.
const EVEN: f32 = 0.02;
/// Maximum number of passes over the vertices.
const PASSES: u32 = 40;

/// Values by sector: rarely more than two.
type Sectors<T> = SmallVec<[T; 2]>;

/// Triangles at a vertex between two seams.
struct Sector {
    /// First side in the ring, and one past the last side.
    range: (usize, usize),
    /// Unit normal.
    normal: Vec3,
    /// Deviation of the triangles after a neighbour has replaced the vertex, as a fraction of the limit.
    error: f32,
    /// Minimum roundness of the triangles.
    roundness: f32,
}

impl Sector {
    /// Returns the sides, counter-clockwise.
    #[inline]
    fn sides<'a>(&self, ring: &'a Ring) -> &'a [Side] {
        &ring.sides[self.range.0..self.range.1]
    }
}

/// Removes vertices not needed by the surface. Neighbours of a removed vertex wait for the next pass, for even
/// coarsening.
pub fn collapse_all(patch: &mut Patch) {
    let is_free = |patch: &Patch, vertex: u32| !patch.is_fixed[vertex as usize];
    let mut waiting: Vec<u32> = (0..patch.positions.len() as u32).filter(|v| is_free(patch, *v)).collect();
    let mut next = Vec::new();
    // By vertex: last pass with a change at a neighbour.
    let mut changed = vec![0; patch.positions.len()];
    let mut ring = Ring::default();
    for pass in 1..=PASSES {
        for vertex in waiting.drain(..) {
            if changed[vertex as usize] == pass {
                continue;
            }
            if collapse(patch, vertex, &mut ring).is_none() {
                // At meeting seams, surfaces may touch without a common edge.
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

/// Removes a vertex if a neighbour can replace it in the triangles of the ring.
fn collapse(patch: &mut Patch, vertex: u32, ring: &mut Ring) -> Option<()> {
    ring.find(patch, vertex)?;
    let sectors = match sectors(patch, vertex, ring) {
        Some(even) if even.iter().all(|sector| sector.error <= EVEN) => even,
        // Removal along a barely visible crease uses up none of the allowed deviation.
        Some(uneven) => creased(patch, vertex, ring, EVEN).unwrap_or(uneven),
        None => creased(patch, vertex, ring, 1.0)?,
    };
    // A vertex on two seams only moves along the seams.
    let neighbours = if ring.seams.is_empty() { &ring.ends[..] } else { &ring.seams };
    let least = sectors.iter().map(|sector| sector.roundness).fold(ROUND_ENOUGH, f32::min);
    // The roundest first.
    let mut candidates: SmallVec<[(f32, u32); MOST]> = SmallVec::new();
    for to in neighbours {
        let own = (roundness_after(patch, ring, &sectors, *to), *to);
        if own.0 > 0.0 && own.0 >= least {
            let is_before = |other: &(f32, u32)| other.0 > own.0 || (other.0 == own.0 && other.1 < own.1);
            candidates.insert(candidates.partition_point(is_before), own);
        }
    }
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

/// Returns the sectors of a ring; `None` if the vertex must stay, for any neighbour.
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
        // A fold may reach beyond the ring.
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

/// Returns the sectors on the two sides of a straight crease through the vertex; the crease then counts as two seams.
/// At a crease the surface bends, or the gradient of looks changes. `None` without a crease whose sectors deviate by
/// at most `most`.
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

/// Returns the deviation of the looks around a vertex from linear looks, as a fraction of the limit: an upper bound
/// for every triangulation of the ring. `place` returns a vertex's position relative to the central vertex.
fn bend(patch: &Patch, sides: &[Side], place: impl Fn(u32) -> Vec3, normal: Vec3) -> Option<f32> {
    let alike = sides.first()?.looks[0];
    if sides.iter().all(|side| side.looks == [alike; 3]) {
        return Some(0.0);
    }
    let look = |look: u32| &patch.looks[look as usize];
    // Linear extrapolation from the largest triangle.
    let area = |side: &Side| place(side.ends[0]).cross(place(side.ends[1])).dot(normal);
    let areas = sides.iter().map(|side| (area(side), side));
    let (most, largest) = areas.max_by(|p, q| p.0.total_cmp(&q.0))?;
    let ([a, b], scale) = (largest.ends.map(&place), 1.0 / most);
    let told = largest.looks.map(look);
    let last = sides.last()?;
    let ends = sides.iter().map(|side| (side.ends[0], side.looks[1])).chain([(last.ends[1], last.looks[2])]);
    let ends: SmallVec<[(&CornerAttributes, f32, f32); MOST + 1]> = ends
        .map(|(end, k)| {
            let at = place(end);
            (look(k), at.cross(b).dot(normal) * scale, a.cross(at).dot(normal) * scale)
        })
        .collect();
    let off = rests(told, &ends, |look| look.normal).length() / NORMAL;
    let off = off.max(rests(told, &ends, |look| look.uv.extend(0.0)).max_element() / UV);
    Some(off.max(rests(told, &ends, |look| look.color).max_element() / COLOR))
}

/// Returns the size of the box around the residuals: looks minus the linear extrapolation of `told`, a triangle's
/// looks. An element of `looks` has the barycentric weights of the second and the third corner.
#[inline]
fn rests(
    told: [&CornerAttributes; 3],
    looks: &[(&CornerAttributes, f32, f32)],
    of: impl Fn(&CornerAttributes) -> Vec3,
) -> Vec3 {
    let [first, second, third] = told.map(&of);
    if second == first && third == first && looks.iter().all(|look| of(look.0) == first) {
        return Vec3::ZERO;
    }
    let (mut low, mut high, mut sum) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
    for (look, u, v) in looks {
        let rest = of(look) - (first + *u * (second - first) + *v * (third - first));
        (low, high, sum) = (low.min(rest), high.max(rest), sum + rest);
    }
    // NaN is in no box.
    if sum.is_finite() { high - low } else { Vec3::INFINITY }
}

/// Returns a triangle's height over its longest side, projected along `normal`: negative from behind.
fn roundness(a: Vec3, b: Vec3, c: Vec3, normal: Vec3) -> f32 {
    let (ab, ac) = (b - a, c - a);
    let longest = ab.length_squared().max(ac.length_squared()).max(b.distance_squared(c));
    ab.cross(ac).dot(normal) / longest
}

/// Returns the minimum roundness of the remaining triangles with this neighbour in place of the vertex; 0 if a sector
/// loses every triangle.
fn roundness_after(patch: &Patch, ring: &Ring, sectors: &[Sector], to: u32) -> f32 {
    let place = |v: u32| patch.positions[v as usize];
    let of = |sector: &Sector| {
        let sides = sector.sides(ring).iter().map(|side| side.ends).filter(|ends| !ends.contains(&to));
        sides.map(|[a, b]| roundness(place(to), place(a), place(b), sector.normal)).reduce(f32::min)
    };
    sectors.iter().map(|sector| of(sector).unwrap_or(0.0)).fold(1.0, f32::min)
}

/// Returns, by sector, the look of the corner in place of the vertex, and the deviation after the replacement; `None`
/// if the deviation exceeds the limit.
fn corners_after(
    patch: &Patch,
    vertex: u32,
    ring: &Ring,
    sectors: &[Sector],
    to: u32,
) -> Option<Sectors<(u32, f32)>> {
    // The vertex is between the ends of the two seams.
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

/// Returns whether no edge gains triangles, and the neighbour's triangle count stays limited.
fn stays_a_surface(patch: &mut Patch, ring: &Ring, to: u32) -> bool {
    let beside: SmallVec<[[u32; 2]; 4]> =
        ring.sides.iter().map(|side| side.ends).filter(|ends| ends.contains(&to)).collect();
    let is_far = |end: &u32| !beside.iter().any(|ends| ends.contains(end));
    let far: SmallVec<[u32; MOST]> = ring.ends.iter().copied().filter(is_far).collect();
    // The removed triangles belong to both vertices.
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
