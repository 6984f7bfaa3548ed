//! Top-level acceleration structure (TLAS): a [BVH8](super::bvh8) over the boxes of instances, each a [BLAS](super::blas) and a
//! transform. A ray is transformed into an instance's space without renormalising its direction, so distances compare.

use super::blas::{Blas, Line, Padded, build};
use super::bvh8::Bvh8;
use super::geometry::Placed;
use super::triangle::TriangleHit;
use glam::{Affine3A, Mat3A, Vec3};
use std::ops::ControlFlow;

/// A model somewhere in the scene.
#[derive(Clone, Debug)]
pub(super) struct Instance {
    /// Index of the model.
    pub model: u32,
    /// Of two copies at one place that with the smaller number counts.
    number: u32,
    /// Number of its first primitive.
    pub first_primitive: u32,
    local_from_model: Affine3A,
    model_from_local: Affine3A,
    /// For vectors across surfaces, as long as an area: the cofactors.
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

    /// A ray in the model's space; distances along it are the same.
    #[inline]
    pub fn line(&self, line: &Line) -> Line {
        Line {
            origin: self.model_from_local.transform_point3(line.origin),
            direction: self.model_from_local.transform_vector3(line.direction),
        }
    }

    /// A place of the model, local space.
    #[inline]
    pub fn place(&self, position: Vec3) -> Vec3 {
        self.local_from_model.transform_point3(position)
    }

    /// A vector across a surface of the model, as long as an area there, local space.
    #[inline]
    pub fn across(&self, spanned: Vec3) -> Vec3 {
        self.across * spanned
    }

    /// The seed of what is left to chance: each copy has its own.
    #[inline]
    pub fn seed(&self, seed: u32) -> u32 {
        crate::random::mix((seed as u64) << 32 | self.number as u64) as u32
    }
}

/// All copies, and a hierarchy over their boxes.
#[derive(Default)]
pub(super) struct Tlas {
    /// In the order of the hierarchy's leaves.
    pub all: Vec<Instance>,
    bvh: Bvh8,
}

impl Tlas {
    /// How far boxes in a model's space grow where those in local space grow by `padding`.
    pub fn padding(model: &Placed, padding: f32) -> f32 {
        let longest = |place: &Affine3A| {
            let Mat3A { x_axis, y_axis, z_axis } = place.matrix3.inverse();
            (x_axis.length_squared() + y_axis.length_squared() + z_axis.length_squared()).sqrt()
        };
        padding * model.local_from_model.iter().map(longest).fold(1.0, f32::max)
    }

    /// Builds the hierarchy over all copies of models with these bounds. Their primitives have the numbers from `first_primitive` on.
    pub fn new(models: &[Placed], bounds: &[(Vec3, Vec3)], padding: f32, first_primitive: u64) -> Self {
        let mut boxes = Vec::new();
        let mut unordered = Vec::new();
        for ((number, model), bounds) in (0u32..).zip(models).zip(bounds) {
            boxes.extend(model.boxes(*bounds).map(|sides| Padded::new(sides, padding)));
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

    /// The nearest triangle that stops the ray before `limit`, with the index of its copy; `strictly` as for
    /// [`Blas::nearest`].
    #[inline(never)]
    pub fn nearest(
        &self,
        line: &Line,
        limit: f32,
        strictly: bool,
        find: impl Fn(&Instance, &Line, f32, bool) -> Option<(usize, TriangleHit)>,
    ) -> Option<(usize, usize, TriangleHit)> {
        let mut best: Option<(usize, usize, TriangleHit)> = None;
        self.bvh.walk(line.origin, line.direction, limit, &mut |place: usize, limit: f32| {
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

    /// The product of what `through` says of each copy before `limit`, linear RGB.
    pub fn product(
        &self,
        blases: &[Blas],
        line: &Line,
        limit: f32,
        through: impl Fn(&Blas, &Line, f32) -> Vec3,
    ) -> Vec3 {
        let mut left = Vec3::ONE;
        self.bvh.walk(line.origin, line.direction, limit, &mut |place: usize, limit: f32| {
            let copy = &self.all[place];
            left *= through(&blases[copy.model as usize], &copy.line(line), limit);
            if left.max_element() > 0.0 { ControlFlow::Continue(limit) } else { ControlFlow::Break(()) }
        });
        left
    }
}
