//! Patches: faces placed in the scene.

use super::cell::Cell;
use super::settings::WaveletError;
use glam::{DAffine3, DMat3, DVec2, DVec3, Vec3};
use rebounce_cad::virtual_mesh::VirtualMesh;
use std::sync::Arc;

/// How unequal the sides of a transformed cube may be.
const UNIFORM: f64 = 1e-6;
/// How far inside of the boundary nearest real points are, part of a cell's side.
const INSET: f64 = 0.125;

/// One side of a face in the scene. A two-sided face is two patches with one mesh.
#[derive(Clone, Debug)]
pub struct WaveletPatch {
    /// The face on the unit square.
    pub mesh: Arc<VirtualMesh>,
    /// From the face's space to local space. Lengths along all directions grow alike, unless the surface is a
    /// plane.
    pub world_from_part: DAffine3,
    /// Whether the patch is the side that the face's normal points away from.
    pub is_back: bool,
    /// Linear RGB reflectance, 0 to 1.
    pub albedo: Vec3,
    /// Linear RGB radiosity of its own light: π × radiance.
    pub emission: Vec3,
}

/// A patch with what follows from its fields.
#[derive(Clone, Debug)]
pub(super) struct PlacedPatch<'a> {
    pub mesh: &'a VirtualMesh,
    pub albedo: DVec3,
    pub emission: DVec3,
    /// Area of the whole unit square, real and virtual.
    pub area: f64,
    /// Area of the face.
    pub real_area: f64,
    /// Centre and radius of a ball around the points of the square.
    pub ball: (DVec3, f64),
    /// Centroid of the face in the square, if that is real.
    pub middle: PatchPoint,
    world_from_part: DAffine3,
    /// Turns normals, also to the side of the patch.
    normal_from_part: DMat3,
}

/// Whether a transform keeps the proportions of areas on a face: any invertible one does on a plane, elsewhere lengths along
/// all directions must grow alike.
pub(super) fn keeps_proportions(world_from_part: &DAffine3, is_planar: bool) -> bool {
    let linear = world_from_part.matrix3;
    let scales = [linear.x_axis, linear.y_axis, linear.z_axis].map(DVec3::length);
    let size = scales[0].max(scales[1]).max(scales[2]);
    let least = scales[0].min(scales[1]).min(scales[2]);
    let volume = linear.determinant();
    let is_uniform = size - least <= UNIFORM * size && volume.abs() >= (1.0 - UNIFORM) * size.powi(3);
    world_from_part.is_finite() && volume != 0.0 && (is_uniform || is_planar)
}

/// Takes normals of a face to normals of its front, or of its back, where it is placed. The length grows as areas across them
/// do.
pub(super) fn normal_from_part(world_from_part: &DAffine3, is_back: bool) -> DMat3 {
    let DMat3 { x_axis, y_axis, z_axis } = world_from_part.matrix3;
    let cofactors = DMat3::from_cols(y_axis.cross(z_axis), z_axis.cross(x_axis), x_axis.cross(y_axis));
    let side = if is_back { -1.0 } else { 1.0 } * world_from_part.matrix3.determinant().signum();
    side * cofactors
}

/// A point of a surface with its normal.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PatchPoint {
    /// Local space.
    pub position: DVec3,
    /// Unit vector.
    pub normal: DVec3,
    /// The nearest real point: visibility is that of it (Alonso et al. 2001, 4.1).
    pub seen_from: DVec3,
    /// Unit normal there.
    pub seen_normal: DVec3,
}

impl<'a> PlacedPatch<'a> {
    /// # Errors
    /// [`WaveletError`] if areas would not keep their proportions, or a number makes no sense.
    pub(super) fn new(patch: &'a WaveletPatch, index: usize) -> Result<Self, WaveletError> {
        if !keeps_proportions(&patch.world_from_part, patch.mesh.is_planar()) {
            return Err(WaveletError::Transform { patch: index });
        }
        let is_colour = |colour: Vec3| colour.is_finite() && colour.min_element() >= 0.0;
        if !is_colour(patch.albedo) || !is_colour(patch.emission) || patch.albedo.max_element() > 1.0 {
            return Err(WaveletError::Material { patch: index });
        }
        let normal_from_part = normal_from_part(&patch.world_from_part, patch.is_back);
        let growth = (normal_from_part * patch.mesh.normal(DVec2::splat(0.5))).length();
        let mut it = Self {
            mesh: &patch.mesh,
            albedo: patch.albedo.as_dvec3(),
            emission: patch.emission.as_dvec3(),
            area: growth * patch.mesh.area(),
            real_area: growth * patch.mesh.real_area(),
            ball: (DVec3::ZERO, 0.0),
            middle: PatchPoint::default(),
            world_from_part: patch.world_from_part,
            normal_from_part,
        };
        it.ball = it.ball_of(Cell::ROOT);
        it.middle = it.point_with_nearest(it.mesh.real_part(Cell::ROOT.corners()).1, 1.0);
        Ok(it)
    }

    /// A real or virtual point; the fields of the nearest real one are its own.
    pub(super) fn point(&self, st: DVec2) -> PatchPoint {
        let [position, normal] = self.mesh.point_and_normal(st);
        let position = self.world_from_part.transform_point3(position);
        let normal = (self.normal_from_part * normal).normalize_or_zero();
        PatchPoint { position, normal, seen_from: position, seen_normal: normal }
    }

    /// A real or virtual point of a cell of this side, with the nearest real one. A point on the boundary,
    /// where another surface may be, is moved inward by a part of the cell.
    pub(super) fn point_with_nearest(&self, st: DVec2, side: f64) -> PatchPoint {
        let point = self.point(st);
        let nearest = self.mesh.well_inside(st, INSET * side);
        if nearest == st {
            return point;
        }
        let real = self.point(nearest);
        if self.mesh.is_real(st) || st.distance(nearest) < 1.25 * INSET * side {
            return real;
        }
        PatchPoint { seen_from: real.position, seen_normal: real.normal, ..point }
    }

    /// Whether all points of a ball are behind it: only where it is a plane.
    pub(super) fn is_behind(&self, (centre, radius): (DVec3, f64)) -> bool {
        self.mesh.is_planar() && (centre - self.middle.position).dot(self.middle.normal) < -radius
    }

    /// A ball around 25 points of a cell, and a quarter more.
    fn ball_of(&self, cell: Cell) -> (DVec3, f64) {
        let points = [0; 25].map(|_| DVec3::ZERO);
        let mut points = points;
        for (i, point) in points.iter_mut().enumerate() {
            let local = DVec2::new((i % 5) as f64, (i / 5) as f64) / 4.0;
            *point = self.point(cell.at(local)).position;
        }
        let centre = points.iter().sum::<DVec3>() / points.len() as f64;
        let radius = points.iter().map(|point| point.distance(centre)).fold(0.0, f64::max);
        (centre, 1.25 * radius)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;

    #[test]
    fn normals_stay_on_their_side_of_a_face_wherever_it_is_placed() {
        let normal = DVec3::new(1.0, 2.0, -0.5).normalize();
        for scale in [DVec3::splat(2.0), DVec3::new(-1.0, 1.0, 1.0), DVec3::new(3.0, -0.5, 1.0)] {
            let turn = DQuat::from_axis_angle(DVec3::new(0.3, 1.0, 0.2).normalize(), 1.3);
            let place = DAffine3::from_scale_rotation_translation(scale, turn, DVec3::new(5.0, 0.0, 1.0));
            let [front, back] = [false, true].map(|is_back| normal_from_part(&place, is_back) * normal);
            // Right angles with the face, and the side that the front's own direction goes to.
            let (along, beside) = normal.any_orthonormal_pair();
            let placed = |direction| place.transform_vector3(direction);
            assert!(front.dot(placed(along)).abs().max(front.dot(placed(beside)).abs()) < 1e-12);
            assert!(front.dot(placed(normal)) > 0.0 && back == -front, "{scale}: {front}");
            let growth = placed(along).cross(placed(beside)).length();
            assert!((front.length() / growth - 1.0).abs() < 1e-12, "{scale}");
        }
    }
}
