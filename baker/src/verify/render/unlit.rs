//! Unlit surfaces: shown in their own colour, independent of lights.

use crate::geometry::{Ray, Surfaces};
use crate::io::picture::{Picture, png};
use crate::random::Stream;
use crate::verify::expose::{Exposure, expose};
use glam::Vec3;
use rebounce_shared::camera::CameraFrame;

/// Renders the unlit surfaces of a picture as linear RGB; the picture, from [`super::render`] or
/// [`path_trace`](crate::verify::path_trace::path_trace) with the same camera and exposure, contains the colour as
/// radiance.
pub fn unlit(surfaces: &impl Surfaces, camera: &CameraFrame, exposure: Exposure) -> Picture {
    let seen = |ray: &Ray, stream: &mut Stream| {
        // First number of the stream, as in the renderers: identical rays pass transparent surfaces.
        let hit = surfaces.see(ray, stream.bits() as u32).filter(|hit| hit.is_unlit);
        hit.map_or(Vec3::ZERO, |hit| surfaces.tint(ray, hit.distance, true) * hit.emission)
    };
    expose(camera, exposure, seen, || ())
}

/// Composes the display picture: subtracts the picture of [`unlit`] from the radiance, exposes the rest by the
/// factor of `exposed`, tone-maps the rest, and adds the [`unlit`] picture unchanged.
pub fn developed(picture: &Picture, unlit: &Picture, exposed: impl Fn(&Picture) -> f32) -> Picture {
    let lit = lit(picture, unlit);
    let lit = png::developed(&lit, exposed(&lit));
    lit.plus(unlit)
}

/// Returns a picture's radiance without that of the [`unlit`] picture.
pub fn lit(picture: &Picture, unlit: &Picture) -> Picture {
    let pixels = picture.pixels.iter().zip(&unlit.pixels);
    Picture { pixels: pixels.map(|(all, part)| (*all - *part).max(Vec3::ZERO)).collect(), ..*picture }
}
