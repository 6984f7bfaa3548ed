//! Top-level acceleration structure (TLAS): a [BVH8](crate::geometry::bvh8) over the boxes of instances. An instance is a
//! [BLAS](super::blas) and a transform. A ray is transformed into an instance's space without renormalising the
//! direction, so distances compare.

use super::blas::{Blas, LocalRay};
use super::geometry::Placed;
use super::triangle::TriangleHit;
use crate::geometry::bvh8::{Bvh8, PaddedBox, build};
use glam::{Affine3A, Mat3A, Vec3};
use std::ops::ControlFlow;

/// An instance of a model.
#[derive(Clone, Debug)]
pub(super) struct Instance {
    /// Index of the model.
    pub model: u32,
    /// Number of the copy: of two copies at an equal place the smaller number counts.
    number: u32,
    /// Number of the first primitive.
    pub first_primitive: u32,
    local_from_model: Affine3A,
    model_from_local: Affine3A,
    /// Cofactor matrix, for normal vectors with an area as length.
    across: Mat3A,
}

impl Instance {
    fn new(model: u32, number: u32, local_from_model: Affine3A) -> Self {
        let Mat3A { x_axis, y_axis, z_axis } = local_from_model.matrix3;
        let across = Mat3A::from_cols(y_axis.cross(z_axis), z_axis.cross(x_axis), x_axis.cross(y_axis));
        let model_from_local = local_from_model.inverse();
        Self { model, number, first_primitive: 0, local_from_model, model_from_local, across }
    }

    #[cfg(test)]
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Number of the copy's offset in a lightmap; 0 is that of triangles without instances.
    #[inline]
    pub fn charts(&self) -> usize {
        self.number as usize + 1
    }

    /// Transforms a ray to model space; distances along the ray stay the same.
    #[inline]
    pub fn line(&self, line: &LocalRay) -> LocalRay {
        LocalRay {
            origin: self.model_from_local.transform_point3(line.origin),
            direction: self.model_from_local.transform_vector3(line.direction),
        }
    }

    /// Transforms a position of the model to local space.
    #[inline]
    pub fn place(&self, position: Vec3) -> Vec3 {
        self.local_from_model.transform_point3(position)
    }

    /// Transforms a normal vector of the model, with an area as length, to local space.
    #[inline]
    pub fn across(&self, spanned: Vec3) -> Vec3 {
        self.across * spanned
    }

    /// Returns the copy's seed of random decisions: copies differ.
    #[inline]
    pub fn seed(&self, seed: u32) -> u32 {
        crate::random::mix((seed as u64) << 32 | self.number as u64) as u32
    }
}

/// Instances, and a BVH8 over the boxes of the instances.
#[derive(Default)]
pub(super) struct Tlas {
    /// Instances, in leaf order.
    pub all: Vec<Instance>,
    bvh: Bvh8,
}

impl Tlas {
    /// Returns the padding of boxes in model space for a `padding` of boxes in local space.
    pub fn padding(model: &Placed, padding: f32) -> f32 {
        let longest = |place: &Affine3A| {
            let Mat3A { x_axis, y_axis, z_axis } = place.matrix3.inverse();
            (x_axis.length_squared() + y_axis.length_squared() + z_axis.length_squared()).sqrt()
        };
        padding * model.local_from_model.iter().map(longest).fold(1.0, f32::max)
    }

    /// Builds the BVH8 over the copies of models with these bounds. Primitives have the numbers from `first_primitive`
    /// on.
    pub fn new(models: &[Placed], bounds: &[(Vec3, Vec3)], padding: f32, first_primitive: u64) -> Self {
        let mut boxes = Vec::new();
        let mut unordered = Vec::new();
        for ((number, model), bounds) in (0u32..).zip(models).zip(bounds) {
            boxes.extend(model.boxes(*bounds).map(|sides| PaddedBox::new(sides, padding)));
            for place in &model.local_from_model {
                unordered.push(Instance::new(number, unordered.len() as u32, *place));
            }
        }
        let (bvh, order) = build(&boxes, 1);
        let mut next = first_primitive;
        let mut ordered = |i: &u32| {
            let copy = unordered[*i as usize].clone();
            let first_primitive = next as u32;
            next += models[copy.model as usize].triangles.len() as u64;
            Instance { first_primitive, ..copy }
        };
        Self { all: order.iter().map(&mut ordered).collect(), bvh }
    }

    /// Returns the nearest triangle stopping the ray before `limit`, with the index of the copy; `strictly` as for
    /// [`Blas::nearest`].
    #[inline(never)]
    pub fn nearest(
        &self,
        line: &LocalRay,
        limit: f32,
        strictly: bool,
        find: impl Fn(&Instance, &LocalRay, f32, bool) -> Option<(usize, TriangleHit)>,
    ) -> Option<(usize, usize, TriangleHit)> {
        let mut best: Option<(usize, usize, TriangleHit)> = None;
        self.bvh.walk(line.origin, line.direction, limit, |place: usize, limit: f32| {
            let copy = &self.all[place];
            let comes_later = best.map_or(strictly, |(other, ..)| self.all[other].number < copy.number);
            match find(copy, &copy.line(line), limit, comes_later) {
                Some((triangle, meeting)) => {
                    best = Some((place, triangle, meeting));
                    ControlFlow::Continue(meeting.distance)
                }
                None => ControlFlow::Continue(limit),
            }
        });
        best
    }

    /// Returns the product of `through` over the copies before `limit`, linear RGB.
    pub fn product(
        &self,
        blases: &[Blas],
        line: &LocalRay,
        limit: f32,
        through: impl Fn(&Blas, &LocalRay, f32) -> Vec3,
    ) -> Vec3 {
        let mut left = Vec3::ONE;
        self.bvh.walk(line.origin, line.direction, limit, |place: usize, limit: f32| {
            let copy = &self.all[place];
            left *= through(&blases[copy.model as usize], &copy.line(line), limit);
            if left.max_element() > 0.0 { ControlFlow::Continue(limit) } else { ControlFlow::Break(()) }
        });
        left
    }
}
