//! Backdrop behind an object.

use crate::geometry::{Ray, Surfaces};
use crate::io::picture::Picture;
use crate::random::Stream;
use crate::verify::expose::{Exposure, expose};
use glam::Vec3;
use rebounce_shared::backdrop::tone;
use rebounce_shared::camera::CameraFrame;
use rebounce_shared::rbn::shown::Ground;

/// Renders the part of a picture without surfaces as display values, linear RGB from 0 to 1: for a picture by
/// [`super::render`] with the same camera and exposure.
pub fn backdrop(
    surfaces: &impl Surfaces,
    camera: &CameraFrame,
    exposure: Exposure,
    ground: &Ground,
) -> Picture {
    let behind = |ray: &Ray, stream: &mut Stream| {
        // First number of the stream, as in the renderers: identical rays pass transparent surfaces.
        match surfaces.see(ray, stream.bits() as u32) {
            Some(_) => Vec3::ZERO,
            None => tone(ground, ray.origin, ray.direction) * surfaces.tint(ray, f32::INFINITY, true),
        }
    };
    expose(camera, exposure, behind, || ())
}
