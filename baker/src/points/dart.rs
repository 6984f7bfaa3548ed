//! Dart throwing: one level's Poisson-disk distribution under the 5D distance of Eq. 11.

use super::SurfacePoint;
use glam::{IVec3, Vec3};
use rebounce_shared::kernel::distance_5d;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

/// A level being filled: no two points nearer than `radius` under the 5D distance.
pub struct DartBoard {
    radius: f32,
    points: Vec<SurfacePoint>,
    cells: HashMap<u64, Vec<u32>, BuildHasherDefault<CellHasher>>,
}

impl DartBoard {
    /// An empty board with this disk radius, scene units.
    pub fn new(radius: f32) -> Self {
        Self { radius, points: Vec::new(), cells: HashMap::default() }
    }

    /// True if the candidate keeps its distance to every point on the board.
    pub fn is_free(&self, candidate: &SurfacePoint) -> bool {
        let cell = self.cell(candidate.position);
        for dz in -1..=1 {
            for dy in -1..=1 {
                for dx in -1..=1 {
                    let Some(near) = self.cells.get(&key(cell + IVec3::new(dx, dy, dz))) else { continue };
                    for &i in near {
                        let other = &self.points[i as usize];
                        let offset = (other.position - candidate.position).length_squared();
                        if offset < self.radius * self.radius
                            && distance_5d(candidate.position, candidate.normal, other.position, other.normal)
                                < self.radius
                        {
                            return false;
                        }
                    }
                }
            }
        }
        true
    }

    /// Puts a point on the board; the caller has asked [`Self::is_free`].
    pub fn insert(&mut self, point: SurfacePoint) {
        self.cells.entry(key(self.cell(point.position))).or_default().push(self.points.len() as u32);
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

    /// The points so far, in the order they came.
    pub fn points(&self) -> &[SurfacePoint] {
        &self.points
    }

    /// The points, in the order they came.
    pub fn into_points(self) -> Vec<SurfacePoint> {
        self.points
    }

    fn cell(&self, position: Vec3) -> IVec3 {
        (position / self.radius).floor().as_ivec3()
    }
}

fn key(cell: IVec3) -> u64 {
    const MASK: u64 = (1 << 21) - 1;
    (cell.x as u64 & MASK) | (cell.y as u64 & MASK) << 21 | (cell.z as u64 & MASK) << 42
}

/// Mixes one 64-bit key.
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
