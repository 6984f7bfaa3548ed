//! What pictures of an object show behind it.

use crate::geometry::{Ray, Surfaces};
use crate::picture::Picture;
use crate::picture::expose::{Exposure, expose};
use crate::random::Stream;
use glam::Vec3;
use rebounce_shared::backdrop::tone;
use rebounce_shared::camera::CameraFrame;
use rebounce_shared::rbn::shown::Ground;

/// The part of a picture that is no surface, as it is shown, linear RGB from 0 to 1: of a picture by [`super::render`] from this
/// camera and with this exposure.
pub fn backdrop(
    surfaces: &impl Surfaces,
    camera: &CameraFrame,
    exposure: Exposure,
    ground: &Ground,
) -> Picture {
    let behind = |ray: &Ray, stream: &mut Stream| {
        // The first number of the stream, as those have it: so the same rays are let through.
        match surfaces.see(ray, stream.bits() as u32) {
            Some(_) => Vec3::ZERO,
            None => tone(ground, ray.origin, ray.direction) * surfaces.tint(ray, f32::INFINITY, true),
        }
    };
    expose(camera, exposure, behind, || ())
}
