//! Dart throwing: one level's Poisson-disk distribution under the 5D distance of Eq. 11. Points of different
//! reconstruction groups do not keep a distance, and the disks of a group have a size of their own.

use super::SurfacePoint;
use glam::{IVec3, Vec3};
use rebounce_shared::kernel::distance_5d;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// Width of a cell over the disk radius: a little over 2, so that points nearer than a disk radius are, along each
/// axis, in the same cell or in the neighbour on the nearer side.
const CELL: f32 = 2.02;
/// End of a chain of points.
const END: u32 = u32::MAX;

/// A level during dart throwing: no two points of a group are nearer than its disk radius under the 5D distance.
pub struct DartBoard {
    radius: f32,
    /// Radii in each reconstruction group, relative to `radius`; beyond the end 1.
    scales: Vec<f32>,
    points: Vec<SurfacePoint>,
    /// Index of the last point inserted into each cell.
    cells: HashMap<u64, u32, BuildHasherDefault<CellHasher>>,
    /// Index of the previous point in the cell, for each point.
    before: Vec<u32>,
}

impl DartBoard {
    /// Creates an empty board with this disk radius, scene units.
    pub fn new(radius: f32) -> Self {
        Self::with_scales(radius, &[])
    }

    /// As [`Self::new`], with radii in reconstruction groups relative to `radius`.
    pub fn with_scales(radius: f32, scales: &[f32]) -> Self {
        Self {
            radius,
            scales: scales.to_vec(),
            points: Vec::new(),
            cells: HashMap::default(),
            before: Vec::new(),
        }
    }

    /// Disk radius in a reconstruction group, scene units.
    #[inline]
    pub fn radius(&self, group: u32) -> f32 {
        self.radius * self.scales.get(group as usize).copied().unwrap_or(1.0)
    }

    /// True if the candidate keeps its distance to every point of its group on the board.
    pub fn is_free(&self, candidate: &SurfacePoint) -> bool {
        let (place, cell) = self.cell(candidate);
        let within = place - cell.as_vec3();
        let nearer = |x: f32| if x < 0.5 { (-1, x) } else { (1, 1.0 - x) };
        let sides = within.to_array().map(nearer);
        for corner in 0..8 {
            // The neighbour cell, and the squared distance to the neighbour, in cells.
            let (mut neighbour, mut away) = (cell, 0.0);
            for (axis, (step, distance)) in sides.into_iter().enumerate() {
                if corner >> axis & 1 == 1 {
                    neighbour[axis] += step;
                    away += distance * distance;
                }
            }
            if away < 0.25 && self.is_near(neighbour, candidate) {
                return false;
            }
        }
        true
    }

    /// True if a point in this cell is too near.
    fn is_near(&self, cell: IVec3, candidate: &SurfacePoint) -> bool {
        let radius = self.radius(candidate.group);
        let mut next = self.cells.get(&key(cell, candidate.group)).copied().unwrap_or(END);
        while let Some(other) = self.points.get(next as usize) {
            let offset = (other.position - candidate.position).length_squared();
            if other.group == candidate.group
                && offset < radius * radius
                && distance_5d(candidate.position, candidate.normal, other.position, other.normal) < radius
            {
                return true;
            }
            next = self.before[next as usize];
        }
        false
    }

    /// Inserts a point; the caller has checked [`Self::is_free`].
    pub fn insert(&mut self, point: SurfacePoint) {
        let last = self.cells.entry(key(self.cell(&point).1, point.group)).or_insert(END);
        self.before.push(std::mem::replace(last, self.points.len() as u32));
        self.points.push(point);
    }

    /// Number of points on the board.
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// True for an empty board.
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Points in the order of insertion.
    pub fn points(&self) -> &[SurfacePoint] {
        &self.points
    }

    /// Points in the order of insertion.
    pub fn into_points(self) -> Vec<SurfacePoint> {
        self.points
    }

    /// Position in units of cells, and the cell.
    fn cell(&self, point: &SurfacePoint) -> (Vec3, IVec3) {
        let place = point.position / (CELL * self.radius(point.group));
        (place, place.floor().as_ivec3())
    }
}

/// Key of a group's cell. Cells of equal keys share a chain.
fn key(cell: IVec3, group: u32) -> u64 {
    const MASK: u64 = (1 << 21) - 1;
    let cell = (cell.x as u64 & MASK) | (cell.y as u64 & MASK) << 21 | (cell.z as u64 & MASK) << 42;
    cell ^ u64::from(group) << 53
}

/// Hasher of a single 64-bit key.
#[derive(Default)]
struct CellHasher(u64);

impl Hasher for CellHasher {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for &b in bytes {
            self.0 = crate::random::mix(self.0 ^ b as u64);
        }
    }

    fn write_u64(&mut self, x: u64) {
        self.0 = crate::random::mix(x);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn free_is_what_brute_force_finds_free() {
        let scales = [1.0, 0.5];
        let mut board = DartBoard::with_scales(0.13, &scales);
        let mut taken = 0;
        for i in 0..6000 {
            let mut s = Stream::new(3, i);
            let position = Vec3::new(s.unit(), s.unit(), 0.2 * s.unit()) * 2.0 - 1.0;
            let normal = (Vec3::Z + 0.5 * s.sphere()).normalize();
            let group = (i % 2) as u32;
            let radius = 0.13 * scales[group as usize];
            let candidate = SurfacePoint { position, normal, geometric_normal: normal, group };
            let near = |p: &SurfacePoint| {
                p.group == group && distance_5d(position, normal, p.position, p.normal) < radius
            };
            let is_free = !board.points().iter().any(near);
            assert_eq!(board.is_free(&candidate), is_free, "{i}");
            if is_free {
                board.insert(candidate);
            }
            taken += !is_free as usize;
        }
        assert!(board.len() > 100 && taken > 1000, "{} and {taken}", board.len());
    }
}
