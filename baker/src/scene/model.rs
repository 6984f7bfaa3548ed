//! Models: instanced meshes, stored once and placed many times.

use glam::{Affine3A, DAffine3, DMat3, DMat4, DVec3, Mat3A, Vec3};
use std::ops::Range;

/// Minimum number of triangles saved by the further instances of a mesh, about half a megabyte of a file, before the
/// mesh becomes a model. A model costs draw calls of its own in every shadow map, too many for small models.
const WORTH_IT: usize = 1 << 16;
/// Maximum size of the largest instance over the smallest: boxes are padded for the smallest instance.
const LARGEST_RATIO: f64 = 256.0;
/// Maximum longest over shortest direction of an instance's transform; and the lower maximum for sheared transforms,
/// which 32-bit numbers invert less exactly.
const MOST_PULLED: f64 = 64.0;
const MOST_SHEARED: f64 = 8.0;
/// Minimum cosine of the angle between two axes of a sheared transform.
const SHEARED: f64 = 1e-3;

/// A mesh with several instances in a scene. The triangles are stored once, in model space: scaled to the size of the
/// largest instance and centred at the origin.
#[derive(Clone, Debug, PartialEq)]
pub struct InstancedMesh {
    /// Range of the model's triangles in the scene's triangles.
    pub triangles: Range<u32>,
    /// Range of the model's vertices in the scene's vertices; unused by other triangles.
    pub vertices: Range<u32>,
    /// Transforms of the instances: invertible and without mirroring.
    pub local_from_model: Vec<Affine3A>,
    /// Least and greatest corner, model space.
    pub bounds: [Vec3; 2],
}

impl InstancedMesh {
    /// Least and greatest corner of each instance's box, local space.
    pub fn boxes(&self) -> impl Iterator<Item = (Vec3, Vec3)> + '_ {
        self.local_from_model.iter().map(|place| bounds_of_copy(place, self.bounds))
    }
}

/// Least and greatest corner, local space, of an instance of the model-space box `[low, high]`.
pub fn bounds_of_copy(local_from_model: &Affine3A, [low, high]: [Vec3; 2]) -> (Vec3, Vec3) {
    let middle = local_from_model.transform_point3(0.5 * (low + high));
    let Mat3A { x_axis, y_axis, z_axis } = local_from_model.matrix3;
    let half = 0.5 * (high - low);
    let half = Vec3::from(x_axis.abs() * half.x + y_axis.abs() * half.y + z_axis.abs() * half.z);
    (middle - half, middle + half)
}

/// As [`bounds_of_copy`], in double precision.
pub fn bounds_of_placed(place: &DAffine3, [low, high]: [DVec3; 2]) -> [DVec3; 2] {
    let middle = place.transform_point3(0.5 * (low + high));
    let (half, DMat3 { x_axis, y_axis, z_axis }) = (0.5 * (high - low), place.matrix3);
    let half = x_axis.abs() * half.x + y_axis.abs() * half.y + z_axis.abs() * half.z;
    [middle - half, middle + half]
}

/// Placements of a mesh that become instances of one model.
pub struct Copies {
    /// Transform of the mesh's vertices into model space.
    pub model_from_mesh: DMat4,
    /// Index of the placement among the mesh's placements, and its instance transform.
    pub placed: Vec<(usize, DAffine3)>,
}

/// Divides the placements of a mesh among models: one for plain and one for mirrored placements, if instancing saves
/// enough triangles. Placements outside both models remain ordinary triangles. `low` and `high` are the mesh's bounds.
pub fn divide(world_from_mesh: &[DMat4], triangles: usize, [low, high]: [DVec3; 2]) -> Vec<Copies> {
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

/// Scale of a mesh at a placement, by its longest axis; `None` if the transform is too flat or too sheared for a model.
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

/// Largest size of the biggest group of sizes within a ratio of `LARGEST_RATIO`.
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
        // A rotation, then a stretch: right angles are lost.
        assert_eq!(copies(&[pulled(5.0) * turn; 3]).len(), 3);
        assert!(copies(&[pulled(60.0) * turn; 3]).is_empty());
        assert!(copies(&[DMat4::from_scale(DVec3::splat(f64::NAN)); 3]).is_empty());
    }
}
