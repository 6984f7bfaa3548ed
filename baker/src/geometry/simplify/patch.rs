//! Patch of triangles with shared vertices and looks.

use super::{Cut, PatchSource};
use glam::{Vec2, Vec3};
use std::collections::HashMap;
use std::ops::ControlFlow;

/// Maximum number of triangles around a vertex; further triangles are not examined.
pub const MOST: usize = 24;

/// Absent corner or vertex.
pub const NONE: u32 = u32::MAX;
/// Maximum range of places per triangle for a dense table.
const NEAR: usize = 16;

/// Maximum change of normals, texture coordinates and colours: 0.5°, 0.5 texels of 1,024, a step of 8 bits.
pub const NORMAL: f32 = 0.01;
pub const UV: f32 = 0.5 / 1024.0;
pub const COLOR: f32 = 1.0 / 256.0;
/// Fraction of the maximum change within which looks are merged; over the rounds the changes may add up to the
/// maximum.
const ALIKE: f32 = 0.25;

/// Appearance of a corner. The surface is smooth across an edge with equal looks on its two sides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerAttributes {
    pub normal: Vec3,
    /// Zero without a texture.
    pub uv: Vec2,
    pub color: Vec3,
    pub material: u32,
}

impl CornerAttributes {
    /// Returns whether two corners at a place have equal looks up to rounding: normals computed per triangle differ
    /// slightly on a flat surface.
    fn is_like(&self, other: &Self) -> bool {
        self.material == other.material
            && self.normal.distance_squared(other.normal) <= (ALIKE * NORMAL).powi(2)
            && self.uv.distance_squared(other.uv) <= (ALIKE * UV).powi(2)
            && self.color.distance_squared(other.color) <= (ALIKE * COLOR).powi(2)
    }
}

/// A triangle of a patch.
#[derive(Clone, Copy, Debug)]
pub struct PatchTriangle {
    pub vertices: [u32; 3],
    /// Indices of the corners' looks.
    pub looks: [u32; 3],
    /// As [`Cut::number`].
    pub number: u32,
    /// As [`Cut::error`].
    pub error: f32,
    pub is_gone: bool,
}

/// Triangles with their own numbering of vertices and looks.
#[derive(Default)]
pub struct Patch {
    pub triangles: Vec<PatchTriangle>,
    pub positions: Vec<Vec3>,
    /// By vertex: whether the vertex must stay in place.
    pub is_fixed: Vec<bool>,
    pub looks: Vec<CornerAttributes>,
    /// By look: a corner of the scene with the look.
    origins: Vec<u32>,
    /// Linked lists of corners: by vertex, the first corner (3 × triangle + corner index); by corner, the next corner.
    first: Vec<u32>,
    next: Vec<u32>,
    /// Maximum displacement of the surface, scene units.
    pub tolerance: f32,
}

impl Patch {
    /// Builds a patch from these triangles. `is_shared` returns whether other patches use a place.
    pub fn new(source: &PatchSource, triangles: &[Cut], is_shared: impl Fn(u32) -> bool) -> Self {
        let mut patch = Self { tolerance: source.tolerance, ..Self::default() };
        let mut numbers = VertexNumbers::new(source, triangles);
        // By look: the previous look at the vertex. By vertex: the last look, and the number of looks.
        let mut before: Vec<u32> = Vec::new();
        let mut last: Vec<(u32, usize)> = Vec::new();
        for cut in triangles {
            let material = source.scene.triangle_material[cut.corners[0] as usize / 3];
            let (mut vertices, mut looks) = ([0; 3], [0; 3]);
            for (k, &corner) in cut.corners.iter().enumerate() {
                let place = source.place(corner);
                let number = numbers.of(place);
                if *number == NONE {
                    *number = patch.positions.len() as u32;
                    patch.positions.push(source.scene.positions[place as usize]);
                    patch.is_fixed.push(is_shared(place));
                    last.push((NONE, 0));
                }
                let (vertex, look) = (*number as usize, source.look(corner, material));
                let (latest, count) = &mut last[vertex];
                let mut known = *latest;
                while known != NONE && *count <= MOST && !patch.looks[known as usize].is_like(&look) {
                    known = before[known as usize];
                }
                if known == NONE || *count > MOST {
                    known = patch.looks.len() as u32;
                    patch.looks.push(look);
                    patch.origins.push(corner);
                    before.push(std::mem::replace(latest, known));
                    *count += 1;
                }
                (vertices[k], looks[k]) = (vertex as u32, known);
            }
            let [a, b, c] = vertices;
            if source.materials[material as usize].is_transparent || a == b || b == c || c == a {
                vertices.iter().for_each(|vertex| patch.is_fixed[*vertex as usize] = true);
            }
            patch.triangles.push(PatchTriangle {
                vertices,
                looks,
                number: cut.number,
                error: cut.error,
                is_gone: false,
            });
        }
        patch.first = vec![NONE; patch.positions.len()];
        patch.next = vec![NONE; 3 * patch.triangles.len()];
        for t in (0..patch.triangles.len()).rev() {
            for (k, vertex) in patch.triangles[t].vertices.into_iter().enumerate() {
                patch.link((3 * t + k) as u32, vertex);
            }
        }
        patch
    }

    /// Returns the remaining triangles, in order.
    pub fn finish(self) -> Vec<Cut> {
        let left = self.triangles.iter().filter(|triangle| !triangle.is_gone);
        let corners = |looks: [u32; 3]| looks.map(|look| self.origins[look as usize]);
        left.map(|t| Cut { corners: corners(t.looks), number: t.number, error: t.error }).collect()
    }

    /// Adds a corner to a vertex.
    pub fn link(&mut self, corner: u32, vertex: u32) {
        self.next[corner as usize] = std::mem::replace(&mut self.first[vertex as usize], corner);
    }

    /// Removes every corner of a vertex.
    pub fn forget(&mut self, vertex: u32) {
        self.first[vertex as usize] = NONE;
    }

    /// Moves these corners of a vertex to a new vertex at the vertex's position; returns the new vertex.
    pub fn part(&mut self, vertex: u32, corners: &[u32]) -> u32 {
        let new = self.positions.len() as u32;
        self.positions.push(self.positions[vertex as usize]);
        self.is_fixed.push(self.is_fixed[vertex as usize]);
        self.first.push(NONE);
        let mut corner = std::mem::replace(&mut self.first[vertex as usize], NONE);
        while corner != NONE {
            let after = self.next[corner as usize];
            let owner = if corners.contains(&corner) { new } else { vertex };
            self.triangles[corner as usize / 3].vertices[corner as usize % 3] = owner;
            self.link(corner, owner);
            corner = after;
        }
        new
    }

    /// Visits the corners of a vertex until a break, and unlinks corners of removed triangles.
    #[inline]
    pub fn corners<B>(
        &mut self,
        vertex: u32,
        mut visit: impl FnMut(u32, &PatchTriangle) -> ControlFlow<B>,
    ) -> ControlFlow<B> {
        let (mut before, mut corner) = (NONE, self.first[vertex as usize]);
        while corner != NONE {
            let after = self.next[corner as usize];
            let triangle = &self.triangles[corner as usize / 3];
            if !triangle.is_gone {
                visit(corner, triangle)?;
                before = corner;
            } else if before == NONE {
                self.first[vertex as usize] = after;
            } else {
                self.next[before as usize] = after;
            }
            corner = after;
        }
        ControlFlow::Continue(())
    }
}

/// Vertex numbers of the places in a patch.
struct VertexNumbers {
    low: u32,
    /// Dense table from the lowest place on, for a small range of places; otherwise empty, with `far` as the table.
    near: Vec<u32>,
    far: HashMap<u32, u32>,
}

impl VertexNumbers {
    fn new(source: &PatchSource, triangles: &[Cut]) -> Self {
        let places = || triangles.iter().flat_map(|cut| cut.corners).map(|corner| source.place(corner));
        let (low, high) = (places().min().unwrap_or(0), places().max().unwrap_or(0));
        let span = (high - low) as usize + 1;
        let is_near = span <= NEAR * triangles.len();
        Self { low, near: vec![NONE; if is_near { span } else { 0 }], far: HashMap::new() }
    }

    /// Returns the vertex number of a place, initially [`NONE`].
    #[inline]
    fn of(&mut self, place: u32) -> &mut u32 {
        match self.near.is_empty() {
            true => self.far.entry(place).or_insert(NONE),
            false => &mut self.near[(place - self.low) as usize],
        }
    }
}
