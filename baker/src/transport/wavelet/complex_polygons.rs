//! Complex polygons: triangles of a mesh put together to planar faces with holes (Alonso et al. 2001, 6.1).

use glam::{DVec2, DVec3};
use rebounce_cad::face::Face;
use rebounce_cad::frame::Frame;
use rebounce_cad::surface::Surface;
use rebounce_cad::trim::{TrimEdge, TrimLoop};
use std::collections::HashMap;

/// Vertices nearer to a face's plane than this part of the mesh's size lie in it.
const COPLANAR: f64 = 1e-6;
/// Sine of the angle between normals of one plane at most.
const PARALLEL: f64 = 1e-3;
/// Triangles with a smaller ratio of height to longest side have no plane of their own.
const SLIVER: f64 = 1e-9;

/// The planar faces of a mesh, each with its material: triangles of one material that are connected by edges
/// and lie in one plane, facing the same way, are one face. All others are faces of their own. `materials`
/// has a number for each triangle.
///
/// Positions are compared bit by bit: vertices at the same position are one. Triangles without area and those
/// that refer to no position are left out. Faces are in the order of their first triangles. A face is never
/// cut at a vertex that two of its loops share, which the even-odd rule allows.
pub fn complex_polygons(positions: &[DVec3], triangles: &[[u32; 3]], materials: &[u32]) -> Vec<(Face, u32)> {
    let mesh = Mesh::new(positions, triangles, materials);
    let groups = mesh.groups();
    groups.iter().filter_map(|group| mesh.face(group)).collect()
}

/// A triangle with a plane.
struct PlaneTriangle {
    vertices: [u32; 3],
    material: u32,
    /// Unit vector.
    normal: DVec3,
}

struct Mesh<'a> {
    positions: &'a [DVec3],
    triangles: Vec<PlaneTriangle>,
    /// Diagonal of the box.
    size: f64,
}

impl<'a> Mesh<'a> {
    fn new(positions: &'a [DVec3], triangles: &[[u32; 3]], materials: &[u32]) -> Self {
        // The first vertex at each position.
        let mut first = HashMap::new();
        let welded: Vec<u32> = positions
            .iter()
            .enumerate()
            .map(|(i, position)| {
                // −0 is 0.
                let bits = (*position + DVec3::ZERO).to_array().map(f64::to_bits);
                *first.entry(bits).or_insert(i as u32)
            })
            .collect();
        let mut all = Vec::new();
        let [mut low, mut high] = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        for (corners, &material) in triangles.iter().zip(materials) {
            if corners.iter().any(|&corner| corner as usize >= positions.len()) {
                continue;
            }
            let vertices = corners.map(|corner| welded[corner as usize]);
            let [a, b, c] = vertices.map(|vertex| positions[vertex as usize]);
            let cross = (b - a).cross(c - a);
            let longest =
                (b - a).length_squared().max((c - a).length_squared()).max((c - b).length_squared());
            if cross.length() > SLIVER * longest {
                (low, high) = (low.min(a).min(b).min(c), high.max(a).max(b).max(c));
                all.push(PlaneTriangle { vertices, material, normal: cross.normalize() });
            }
        }
        let size = if all.is_empty() { 0.0 } else { low.distance(high) };
        Self { positions, triangles: all, size }
    }

    fn position(&self, vertex: u32) -> DVec3 {
        self.positions[vertex as usize]
    }

    /// Triangles of each face: from the first that is in none, over edges that two triangles go along in
    /// opposite directions.
    fn groups(&self) -> Vec<Vec<usize>> {
        let mut edges: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
        for (index, triangle) in self.triangles.iter().enumerate() {
            for edge in sides(triangle.vertices) {
                edges.entry(edge).or_default().push(index);
            }
        }
        let mut is_taken = vec![false; self.triangles.len()];
        let mut groups = Vec::new();
        for seed in 0..self.triangles.len() {
            if is_taken[seed] {
                continue;
            }
            is_taken[seed] = true;
            let mut group = vec![seed];
            let mut next = 0;
            while let Some(&index) = group.get(next) {
                next += 1;
                for [a, b] in sides(self.triangles[index].vertices) {
                    // More than two triangles at an edge are not one surface.
                    let [along, across] =
                        [[a, b], [b, a]].map(|edge| edges.get(&edge).map_or(&[][..], |it| it));
                    if let ([_], &[other]) = (along, across)
                        && !is_taken[other]
                        && self.is_coplanar(seed, other)
                    {
                        is_taken[other] = true;
                        group.push(other);
                    }
                }
            }
            groups.push(group);
        }
        groups
    }

    /// Whether a triangle lies in the plane of the first of a face, and is of its material.
    fn is_coplanar(&self, seed: usize, other: usize) -> bool {
        let [seed, other] = [seed, other].map(|index| &self.triangles[index]);
        let origin = self.position(seed.vertices[0]);
        let is_in_plane =
            |&vertex: &u32| (self.position(vertex) - origin).dot(seed.normal).abs() <= COPLANAR * self.size;
        seed.material == other.material
            && seed.normal.dot(other.normal) > 0.0
            && seed.normal.cross(other.normal).length() <= PARALLEL
            && other.vertices.iter().all(is_in_plane)
    }

    /// The face of coplanar triangles: edges that no two of them share, chained to loops.
    fn face(&self, group: &[usize]) -> Option<(Face, u32)> {
        let seed = &self.triangles[*group.first()?];
        let [a, b, _] = seed.vertices.map(|vertex| self.position(vertex));
        let frame = Frame::new(a, seed.normal, b - a)?;
        let all = || group.iter().flat_map(|&index| sides(self.triangles[index].vertices));
        let mut counts: HashMap<[u32; 2], i32> = HashMap::new();
        for edge in all() {
            *counts.entry(edge).or_default() += 1;
        }
        let is_outer = |[a, b]: &[u32; 2]| !counts.contains_key(&[*b, *a]);
        let outer: Vec<[u32; 2]> = all().filter(is_outer).collect();
        let at = |vertex: u32| {
            let local = frame.local(self.position(vertex));
            DVec2::new(local.x, local.y)
        };
        let chains = chained(&outer);
        let loops =
            chains.iter().map(|vertices| outline(&vertices.iter().map(|&v| at(v)).collect::<Vec<_>>()));
        let loops: Vec<TrimLoop> = loops.collect();
        let face = Face { surface: Surface::Plane(frame), is_reversed: false, loops };
        (!face.loops.is_empty()).then_some((face, seed.material))
    }
}

/// The directed edges of a triangle.
fn sides([a, b, c]: [u32; 3]) -> [[u32; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

/// Loops of directed edges, in the order of the edges that begin them. As many edges end at a vertex as begin
/// there.
fn chained(edges: &[[u32; 2]]) -> Vec<Vec<u32>> {
    let mut from: HashMap<u32, Vec<usize>> = HashMap::new();
    for (index, edge) in edges.iter().enumerate().rev() {
        from.entry(edge[0]).or_default().push(index);
    }
    let mut is_used = vec![false; edges.len()];
    let mut chains = Vec::new();
    for begin in 0..edges.len() {
        if is_used[begin] {
            continue;
        }
        let mut chain = Vec::new();
        let mut edge = begin;
        loop {
            is_used[edge] = true;
            chain.push(edges[edge][0]);
            let following = from.get_mut(&edges[edge][1]);
            let next = following.and_then(|list| {
                while let Some(index) = list.pop() {
                    if !is_used[index] {
                        return Some(index);
                    }
                }
                None
            });
            match next {
                Some(next) if edges[edge][1] != edges[begin][0] => edge = next,
                _ => break,
            }
        }
        chains.push(chain);
    }
    chains
}

/// The segments between points, each to the next and the last to the first.
fn outline(points: &[DVec2]) -> TrimLoop {
    let next = points.iter().cycle().skip(1);
    points.iter().zip(next).map(|(&from, &to)| TrimEdge::Segment { from, to }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_cad::trim::TrapezoidalMap;
    use rebounce_cad::virtual_mesh::VirtualMesh;

    /// Squares of a grid in a tilted plane, as two triangles each, but for those left out.
    fn grid(size: u32, is_left_out: impl Fn(u32, u32) -> bool) -> (Vec<DVec3>, Vec<[u32; 3]>) {
        let frame = Frame::new(DVec3::ONE, DVec3::new(0.2, 1.0, -0.3), DVec3::X).unwrap();
        let side = size + 1;
        let place = |i: u32| frame.place(DVec3::new(f64::from(i % side), f64::from(i / side), 0.0));
        let mut triangles = Vec::new();
        for y in 0..size {
            for x in 0..size {
                if !is_left_out(x, y) {
                    let corner = x + side * y;
                    triangles.push([corner, corner + 1, corner + side + 1]);
                    triangles.push([corner, corner + side + 1, corner + side]);
                }
            }
        }
        ((0..side * side).map(place).collect(), triangles)
    }

    #[test]
    fn a_grid_with_holes_is_one_face() {
        let (positions, triangles) = grid(9, |x, y| (x, y) == (2, 2) || (5..7).contains(&x) && y == 5);
        let faces = complex_polygons(&positions, &triangles, &vec![3; triangles.len()]);
        let [(face, 3)] = &faces[..] else { panic!("{} faces", faces.len()) };
        assert_eq!(face.loops.len(), 3);
        assert!((TrapezoidalMap::new(&face.loops).unwrap().area() - 78.0).abs() < 1e-9);
        let mesh = VirtualMesh::new(face).unwrap();
        assert!((mesh.area() - 81.0).abs() < 1e-9 && (mesh.real_area() - 78.0).abs() < 1e-9);
        // The normal is that of the triangles.
        let [a, b, c] = triangles[0].map(|vertex| positions[vertex as usize]);
        assert!(mesh.normal(DVec2::splat(0.5)).dot((b - a).cross(c - a)) > 0.0);
    }

    #[test]
    fn materials_folds_and_gaps_divide() {
        let (positions, triangles) = grid(4, |x, _| x == 2);
        // Two parts beside a gap, of which the first is divided by material.
        let materials: Vec<u32> = triangles.iter().map(|t| u32::from(t[0] % 5 < 2 && t[0] / 5 < 1)).collect();
        let faces = complex_polygons(&positions, &triangles, &materials);
        assert_eq!(faces.iter().map(|(_, material)| *material).collect::<Vec<_>>(), [1, 0, 0]);
        let area: f64 = faces.iter().map(|(face, _)| TrapezoidalMap::new(&face.loops).unwrap().area()).sum();
        assert!((area - 12.0).abs() < 1e-9);
        // The sides of a box, with vertices of their own for each triangle.
        let corner = |i: u32| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2));
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let corners = quads.iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d]);
        let positions: Vec<DVec3> = corners.map(|&i| corner(i)).collect();
        let triangles: Vec<[u32; 3]> = (0..12).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
        let faces = complex_polygons(&positions, &triangles, &[0; 12]);
        assert_eq!(faces.len(), 6);
        assert!(faces.iter().all(|(face, _)| face.loops.len() == 1 && face.loops[0].len() == 4));
        // Curved surfaces stay triangles; slivers and wrong indices are left out.
        let bowl =
            |i: u32| DVec3::new(f64::from(i % 4), f64::from(i / 4), f64::from((i % 4) * (i / 4)).powi(2));
        let positions: Vec<DVec3> = (0..16).map(bowl).collect();
        let triangles = [[5, 6, 10], [5, 10, 9], [0, 0, 1], [1, 2, 99], [0, 1, 2]];
        assert_eq!(complex_polygons(&positions, &triangles, &[0; 5]).len(), 2);
    }

    #[test]
    fn loops_that_touch_at_a_vertex_keep_the_area() {
        let (positions, triangles) = grid(4, |x, y| (x, y) == (1, 1) || (x, y) == (2, 2));
        let faces = complex_polygons(&positions, &triangles, &vec![0; triangles.len()]);
        assert_eq!(faces.len(), 1);
        let area = TrapezoidalMap::new(&faces[0].0.loops).unwrap().area();
        assert!((area - 14.0).abs() < 1e-9, "{area}");
    }
}
