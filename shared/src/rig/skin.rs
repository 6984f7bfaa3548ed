//! Vertices in a pose, and points that ride on their triangles: the twin of `skin.wgsl`.

use super::pose::Pose;
use super::{Rig, RigMesh, RigPoint, RigVertex};
use crate::octahedral::{pack_rounded, unpack_snorm16};
use crate::rbn::bulk::Vertex;
use glam::{Affine3A, Mat3A, Vec3, Vec3A};

/// Position and unit normal of a vertex in a pose, local space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SkinnedVertex {
    /// Local space.
    pub position: Vec3,
    /// Unit.
    pub normal: Vec3,
}

/// Returns the vertices of the rig in a pose, in the order of [`Rig::vertices`].
pub fn skinned(rig: &Rig, pose: &Pose) -> Vec<SkinnedVertex> {
    let mut out = vec![SkinnedVertex::default(); rig.vertices.len()];
    let (mut first_matrix, mut first_weight) = (0, 0);
    for mesh in &rig.layout.meshes {
        let matrices = &pose.matrices[first_matrix..first_matrix + mesh.matrix_count()];
        let matrices: Vec<Affine3A> = matrices.iter().map(|matrix| matrix.local_from_model()).collect();
        let weights = &pose.weights[first_weight..first_weight + mesh.weights.len()];
        let first = mesh.first_vertex as usize;
        for i in 0..mesh.vertex_count as usize {
            out[first + i] = vertex(rig, mesh, i, &matrices, weights);
        }
        first_matrix += mesh.matrix_count();
        first_weight += mesh.weights.len();
    }
    out
}

fn vertex(rig: &Rig, mesh: &RigMesh, i: usize, matrices: &[Affine3A], weights: &[f32]) -> SkinnedVertex {
    let bind = &rig.vertices[mesh.first_vertex as usize + i];
    let (mut position, mut normal) = (Vec3::from(bind.position), unpack_snorm16(bind.normal));
    for (target, weight) in weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0) {
        let delta = &rig.deltas[mesh.first_delta as usize + target * mesh.vertex_count as usize + i];
        position += *weight * Vec3::from(delta.position);
        normal += *weight * Vec3::from(delta.normal);
    }
    let mut matrix = Affine3A { matrix3: Mat3A::ZERO, translation: Vec3A::ZERO };
    for (joint, weight) in joints(bind) {
        if weight > 0.0 {
            let joint = &matrices[joint as usize];
            matrix.matrix3 += joint.matrix3 * weight;
            matrix.translation += joint.translation * weight;
        }
    }
    let normal = cofactors(&matrix.matrix3) * Vec3A::from(normal);
    SkinnedVertex {
        position: matrix.transform_point3(position),
        normal: normal.normalize_or(Vec3A::Y).into(),
    }
}

/// The four joints of a vertex with their weights, which add up to 1.
fn joints(vertex: &RigVertex) -> [(u32, f32); 4] {
    let half = |words: [u32; 2], i: usize| words[i / 2] >> (16 * (i % 2)) & 0xffff;
    std::array::from_fn(|i| (half(vertex.joints, i), half(vertex.weights, i) as f32 / 65_535.0))
}

/// Matrix for normals: the inverse transpose up to a positive factor.
fn cofactors(linear: &Mat3A) -> Mat3A {
    let [x, y, z] = [linear.x_axis, linear.y_axis, linear.z_axis];
    let sign = if x.cross(y).dot(z) < 0.0 { -1.0 } else { 1.0 };
    Mat3A::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign
}

/// Puts skinned vertices into the vertices of a file.
pub fn put(rig: &Rig, skinned: &[SkinnedVertex], vertices: &mut [Vertex]) {
    for (of, at) in rig.vertices.iter().zip(skinned) {
        if let Some(vertex) = vertices.get_mut(of.vertex as usize) {
            (vertex.position, vertex.normal) = (at.position.to_array(), pack_rounded(at.normal));
        }
    }
}

/// A point in a pose.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RiddenPoint {
    /// Local space.
    pub position: Vec3,
    /// Unit.
    pub normal: Vec3,
}

/// Returns where a point is on its triangle. The normal is the vertices' mean, on the front of the triangle: a point on the back of
/// a surface has the corners in the other order.
pub fn ridden(point: &RigPoint, skinned: &[SkinnedVertex]) -> RiddenPoint {
    let [a, b, c] = point.corners.map(|corner| skinned[corner as usize]);
    let [v, w] = point.barycentric;
    let u = 1.0 - v - w;
    let mean = |a: Vec3, b: Vec3, c: Vec3| u * a + v * b + w * c;
    let normal = mean(a.normal, b.normal, c.normal).normalize_or(a.normal);
    let front = (b.position - a.position).cross(c.position - a.position);
    RiddenPoint {
        position: mean(a.position, b.position, c.position),
        normal: if front.dot(normal) < 0.0 { -normal } else { normal },
    }
}
