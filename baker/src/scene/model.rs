//! Models: what stands in a scene many times, and is in memory once.

use super::WorldMesh;
use glam::{Affine3A, DAffine3, DMat3, DMat4, DVec3, Mat3A, Vec3};
use std::ops::Range;

/// Triangles that further copies of a mesh must spare for it to become a model: half a megabyte of a file. Each model costs
/// draw calls of its own in every shadow map, which many small ones would not be worth.
const WORTH_IT: usize = 1 << 16;
/// The largest copy of a model over the smallest: boxes are padded for the smallest, so smaller ones stand alone.
const LARGEST_RATIO: f64 = 256.0;
/// Copies of all models at most.
pub(super) const MOST_COPIES: usize = 1 << 22;

/// Triangles that stand in a scene more than once. They are there once, in a space of their own, in which the largest copy
/// has its size and the middle is the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    /// Its triangles among the scene's.
    pub triangles: Range<u32>,
    /// Its vertices among the scene's, which no other triangles use.
    pub vertices: Range<u32>,
    /// Where its copies stand. None is mirrored, and all can be inverted.
    pub local_from_model: Vec<Affine3A>,
    /// Least and greatest corner, model space.
    pub bounds: [Vec3; 2],
}

impl Model {
    /// Least and greatest corner of each copy's box, local space.
    pub fn boxes(&self) -> impl Iterator<Item = (Vec3, Vec3)> + '_ {
        self.local_from_model.iter().map(|place| bounds_of_copy(place, self.bounds))
    }
}

/// Least and greatest corner, local space, of a copy of what lies within these bounds.
pub(crate) fn bounds_of_copy(local_from_model: &Affine3A, [low, high]: [Vec3; 2]) -> (Vec3, Vec3) {
    let middle = local_from_model.transform_point3(0.5 * (low + high));
    let Mat3A { x_axis, y_axis, z_axis } = local_from_model.matrix3;
    let half = 0.5 * (high - low);
    let half = Vec3::from(x_axis.abs() * half.x + y_axis.abs() * half.y + z_axis.abs() * half.z);
    (middle - half, middle + half)
}

/// A model on its way to a [`Scene`](super::Scene).
#[derive(Default)]
pub(super) struct WorldModel {
    /// In model space.
    pub mesh: WorldMesh,
    /// Where it stands.
    pub world_from_model: Vec<DAffine3>,
}

impl WorldModel {
    /// Least and greatest corner of each copy's box, world space.
    pub fn boxes(&self) -> impl Iterator<Item = [DVec3; 2]> + '_ {
        let [low, high] = self.mesh.bounds().unwrap_or_default();
        self.world_from_model.iter().map(move |place| {
            let middle = place.transform_point3(0.5 * (low + high));
            let (half, DMat3 { x_axis, y_axis, z_axis }) = (0.5 * (high - low), place.matrix3);
            let half = x_axis.abs() * half.x + y_axis.abs() * half.y + z_axis.abs() * half.z;
            [middle - half, middle + half]
        })
    }
}

/// The copies of a mesh that can be copies of one model.
pub(super) struct Copies {
    /// What makes the model's vertices of the mesh's.
    pub model_from_mesh: DMat4,
    /// Where they stand, and which of the mesh's places each is.
    pub placed: Vec<(usize, DAffine3)>,
}

/// Divides a mesh's places among models: one for copies, one for mirrored copies, as far as it is worth it. What none has
/// stands alone. `low` and `high` are the mesh's bounds.
pub(super) fn divide(world_from_mesh: &[DMat4], triangles: usize, [low, high]: [DVec3; 2]) -> Vec<Copies> {
    let size = |place: &DMat4| {
        let DMat3 { x_axis, y_axis, z_axis } = DMat3::from_mat4(*place);
        x_axis.length().max(y_axis.length()).max(z_axis.length())
    };
    let largest = world_from_mesh.iter().map(size).fold(0.0, f64::max);
    let is_regular = |place: &DMat4| {
        let inverse = DMat3::from_mat4(*place).inverse();
        let columns = [inverse.x_axis, inverse.y_axis, inverse.z_axis];
        let longest = columns.iter().map(|column| column.length()).fold(0.0, f64::max);
        inverse.is_finite() && longest * largest <= LARGEST_RATIO
    };
    if !(largest.is_normal() && low.is_finite() && high.is_finite()) {
        return Vec::new();
    }
    let is_mirrored = |place: &DMat4| DMat3::from_mat4(*place).determinant() < 0.0;
    let models = [false, true].into_iter().filter_map(|mirrored| {
        let some = world_from_mesh.iter().enumerate();
        let some: Vec<(usize, &DMat4)> =
            some.filter(|(_, place)| is_regular(place) && is_mirrored(place) == mirrored).collect();
        if some.len().saturating_sub(1).saturating_mul(triangles) < WORTH_IT {
            return None;
        }
        let scale = DVec3::new(if mirrored { -largest } else { largest }, largest, largest);
        let model_from_mesh = DMat4::from_scale(scale) * DMat4::from_translation(-0.5 * (low + high));
        let mesh_from_model = model_from_mesh.inverse();
        let placed =
            |(number, place): (usize, &DMat4)| (number, DAffine3::from_mat4(*place * mesh_from_model));
        Some(Copies { model_from_mesh, placed: some.into_iter().map(placed).collect() })
    });
    models.collect()
}
