//! A side of a primitive of an object, and places on it.

use crate::geometry::{Primitives, SurfaceCoordinates, SurfaceSample};
use crate::random::Stream;
use glam::{Vec2, Vec3};

/// A side of a primitive.
#[derive(Clone, Copy, Debug)]
pub(super) struct ObjectSide {
    /// Number of the primitive.
    pub primitive: u32,
    /// Whether it is the back.
    pub is_back: bool,
    /// Twice the area, scene units squared.
    pub area: f32,
}

/// A place of a side, and the unit normal of the true surface there, on that side.
pub(super) fn place(
    primitives: &dyn Primitives,
    side: &ObjectSide,
    stream: &mut Stream,
) -> (SurfaceSample, Vec3) {
    let square = stream.square();
    let at = if square.element_sum() > 1.0 { 1.0 - square } else { square };
    let (primitive, is_back) = (side.primitive, side.is_back);
    let spot = primitives.spot(SurfaceCoordinates { primitive, at, is_back }, 0.0);
    let [a, b, c] = corners(primitives, primitive);
    let across = (b - a).cross(c - a).normalize_or_zero();
    let geometric_normal = if across.dot(spot.normal) < 0.0 { -across } else { across };
    (spot, geometric_normal)
}

/// The corners of a primitive's front, at its [coordinates](SurfaceCoordinates::at).
pub(super) fn corners(primitives: &dyn Primitives, primitive: u32) -> [Vec3; 3] {
    [Vec2::ZERO, Vec2::X, Vec2::Y]
        .map(|at| primitives.spot(SurfaceCoordinates { primitive, at, is_back: false }, 0.0).position)
}
