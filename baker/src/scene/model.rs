//! Models: what stands in a scene many times, and is in memory once.

use super::WorldMesh;
use glam::{Affine3A, DAffine3, DMat3, DMat4, DVec3, Mat3A, Vec3};
use std::ops::Range;

/// Triangles that further copies of a mesh must spare for it to become a model: half a megabyte of a file. Each model costs
/// draw calls of its own in every shadow map, which many small ones would not be worth.
const WORTH_IT: usize = 1 << 16;
/// The largest copy of a model over the smallest: boxes are padded for the smallest.
const LARGEST_RATIO: f64 = 256.0;
/// A copy's longest direction over its shortest, at most; and where it is sheared, as 32-bit numbers turn that back less well.
const MOST_PULLED: f64 = 64.0;
const MOST_SHEARED: f64 = 8.0;
/// Cosine of the angle between two axes beyond which a place is sheared.
const SHEARED: f64 = 1e-3;

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
    if !(low.is_finite() && high.is_finite()) {
        return Vec::new();
    }
    let sizes: Vec<Option<f64>> = world_from_mesh.iter().map(size).collect();
    let Some(largest) = largest_of_most(sizes.iter().flatten().copied().collect()) else {
        return Vec::new();
    };
    let is_regular =
        |number: usize| sizes[number].is_some_and(|size| (largest / LARGEST_RATIO..=largest).contains(&size));
    let is_mirrored = |place: &DMat4| DMat3::from_mat4(*place).determinant() < 0.0;
    let models = [false, true].into_iter().filter_map(|mirrored| {
        let some = world_from_mesh.iter().enumerate();
        let some: Vec<(usize, &DMat4)> =
            some.filter(|(number, place)| is_regular(*number) && is_mirrored(place) == mirrored).collect();
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

/// How large a mesh is at a place; `None` where the place is too flat, or too sheared, for a model.
fn size(place: &DMat4) -> Option<f64> {
    let matrix = DMat3::from_mat4(*place);
    let axes = |m: DMat3| [m.x_axis, m.y_axis, m.z_axis];
    let longest = |m: DMat3| axes(m).into_iter().map(DVec3::length).fold(0.0, f64::max);
    let inverse = matrix.inverse();
    let (size, pulled) = (longest(matrix), longest(matrix) * longest(inverse));
    let [x, y, z] = axes(matrix).map(DVec3::normalize_or_zero);
    let is_sheared = [x.dot(y), y.dot(z), z.dot(x)].iter().any(|cosine| cosine.abs() > SHEARED);
    let most = if is_sheared { MOST_SHEARED } else { MOST_PULLED };
    (inverse.is_finite() && size.is_normal() && pulled <= most).then_some(size)
}

/// The largest of those sizes that differ by no more than a model's may, and are the most.
fn largest_of_most(mut sizes: Vec<f64>) -> Option<f64> {
    sizes.sort_unstable_by(f64::total_cmp);
    let (mut first, mut most) = (0, (0, None));
    for (last, &size) in sizes.iter().enumerate() {
        while size > LARGEST_RATIO * sizes[first] {
            first += 1;
        }
        if last + 1 - first >= most.0 {
            most = (last + 1 - first, Some(size));
        }
    }
    most.1
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(scale: DVec3) -> DMat4 {
        DMat4::from_scale(scale)
    }

    fn copies(places: &[DMat4]) -> Vec<usize> {
        let taken = divide(places, WORTH_IT, [DVec3::ZERO, DVec3::ONE]);
        let mut taken: Vec<usize> =
            taken.into_iter().flat_map(|c| c.placed).map(|(number, _)| number).collect();
        taken.sort_unstable();
        taken
    }

    #[test]
    fn a_few_odd_places_keep_nobody_from_being_a_model() {
        let usual = vec![at(DVec3::ONE); 5];
        for odd in [DVec3::splat(1000.0), DVec3::splat(1e-4), DVec3::new(1000.0, 0.0, 1000.0), DVec3::ZERO] {
            assert_eq!(copies(&[&usual[..], &[at(odd)]].concat()), [0, 1, 2, 3, 4], "{odd}");
        }
        let mirrored = vec![at(DVec3::new(1.0, -1.0, 1.0)); 5];
        assert_eq!(copies(&[usual, mirrored].concat()).len(), 10);
    }

    #[test]
    fn places_that_32_bits_cannot_turn_back_stand_alone() {
        let turn = DMat4::from_rotation_z(0.7);
        let pulled = |by: f64| at(DVec3::new(by, 1.0, 1.0));
        assert_eq!(copies(&[pulled(60.0); 3]).len(), 3);
        assert!(copies(&[pulled(70.0); 3]).is_empty());
        // A turn, then a pull: what was square is no longer.
        assert_eq!(copies(&[pulled(5.0) * turn; 3]).len(), 3);
        assert!(copies(&[pulled(60.0) * turn; 3]).is_empty());
        assert!(copies(&[DMat4::from_scale(DVec3::splat(f64::NAN)); 3]).is_empty());
    }
}
