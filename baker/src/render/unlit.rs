//! What unlit surfaces show: their colour, whatever the light.

use crate::geometry::{Ray, Surfaces};
use crate::picture::expose::{Exposure, expose};
use crate::picture::{Picture, png};
use crate::random::Stream;
use glam::Vec3;
use rebounce_shared::camera::CameraFrame;

/// The part of a picture that unlit surfaces are, linear RGB: of a picture by [`super::render`] or
/// [`path_trace`](crate::path_trace::path_trace) from this camera and with this exposure, in which it is radiance.
pub fn unlit(surfaces: &impl Surfaces, camera: &CameraFrame, exposure: Exposure) -> Picture {
    let seen = |ray: &Ray, stream: &mut Stream| {
        // The first number of the stream, as those have it: so the same rays are let through.
        let hit = surfaces.see(ray, stream.bits() as u32).filter(|hit| hit.is_unlit);
        hit.map_or(Vec3::ZERO, |hit| surfaces.tint(ray, hit.distance, true) * hit.emission)
    };
    expose(camera, exposure, seen, || ())
}

/// Such a picture with the part of it that is [`unlit`], as it is shown: the rest is exposed, with the factor that `exposed`
/// gives for it, and tone-mapped.
pub fn developed(picture: &Picture, unlit: &Picture, exposed: impl Fn(&Picture) -> f32) -> Picture {
    let pixels = picture.pixels.iter().zip(&unlit.pixels);
    let lit =
        Picture { pixels: pixels.map(|(all, part)| (*all - *part).max(Vec3::ZERO)).collect(), ..*picture };
    let lit = png::developed(&lit, exposed(&lit));
    lit.plus(unlit)
}
