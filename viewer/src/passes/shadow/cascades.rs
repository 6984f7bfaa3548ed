//! Cascades: shadow maps of directional lights for the visible part of the scene, each a third as wide as the next;
//! computed on the CPU.
//!
//! A cascade is a square of fixed width in the light's projection, around the part of the view frustum that fits
//! into the square (Dimitrov 2007, Cascaded Shadow Maps). The square moves in steps of a large whole number of
//! texels, so texels keep their places in the scene, shadows do not shimmer while the camera turns, and a cascade
//! is redrawn only after a step.

use super::fit::{BORDER, CASCADES, LARGEST, Parallel, middle, reach};
use crate::scene::extent::Extent;
use glam::{Mat4, Vec3};
use rebounce_shared::camera::CameraFrame;

/// Widths of cascades as shares of the scene's width.
const WIDTHS: [f32; CASCADES as usize] = [1.0 / 9.0, 1.0 / 3.0, 1.0];
/// Number of movement steps across a cascade.
const STEPS: f32 = 16.0;
/// Maximum bytes of all cascades.
const BUDGET: u64 = 48 << 20;

/// Width and height of a cascade's map, texels, for `suns` directional lights, a picture of this height and other
/// maps of size `others`: about as fine as the picture's pixels at the far end of the cascade, and no coarser than
/// the other maps.
pub fn size(suns: u32, height: u32, others: u32) -> u32 {
    let layer = BUDGET / u64::from(4 * CASCADES * suns);
    let mut size = LARGEST;
    while size > 256 && (size > others.max(5 * height) || u64::from(size).pow(2) > layer) {
        size /= 2;
    }
    size
}

/// A camera's view frustum, as a cone.
pub struct Seen {
    eye: Vec3,
    forward: Vec3,
    /// Tangent of the angle between `forward` and the picture's corners.
    tan: f32,
}

impl Seen {
    /// From a camera and a picture size.
    pub fn new(camera: &CameraFrame, [width, height]: [u32; 2]) -> Self {
        let tan = camera.tan_half_yfov * (1.0 + (width as f32 / height as f32).powi(2)).sqrt();
        Self { eye: camera.eye, forward: camera.forward, tan }
    }
}

/// Projections of a light's cascades, from narrow to wide, on maps of this size.
pub fn fit(direction: Vec3, extent: &Extent, seen: &Seen, size: u32) -> [Mat4; CASCADES as usize] {
    let sun = Parallel::new(direction, extent.all);
    let all = extent.detail.unwrap_or(extent.all);
    let whole = sun.half_width(all);
    WIDTHS.map(|share| {
        let half = whole * share * (1.0 + 2.0 * BORDER / size as f32);
        // Whole texels.
        let step = 2.0 * half / STEPS;
        // Centre of the sphere around the frustum, as far as the sphere fits beside the steps.
        let at = seen.eye + seen.forward * ((half - 0.5 * step) / seen.tan.max(1.0));
        // Keeps the map within the scene if possible.
        let along = |axis: Vec3| {
            let (middle, free) = (axis.dot(middle(all)), (reach(axis, all) - half).max(0.0));
            let steps = ((axis.dot(at) - middle).max(-free).min(free) / step + 0.5).floor();
            middle + steps * step
        };
        sun.view(along(sun.right), along(sun.up), half)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::camera::Camera;

    const SIZE: u32 = 1024;

    fn seen(position: [f64; 3], angle: f64) -> (Seen, CameraFrame) {
        let target = [position[0] + angle.sin(), position[1] - 0.1, position[2] - angle.cos()];
        let camera = Camera { position, target, up: [0.0, 1.0, 0.0], yfov_deg: 60.0 }.frame([0.0; 3]);
        (Seen::new(&camera, [640, 360]), camera)
    }

    fn house() -> Extent {
        Extent { all: [Vec3::new(-9.0, 0.0, -8.0), Vec3::new(11.0, 4.0, 9.0)], detail: None }
    }

    fn width(matrix: &Mat4) -> f32 {
        2.0 / matrix.row(0).truncate().length()
    }

    #[test]
    fn what_is_near_lies_in_the_narrow_cascade_and_all_in_the_widest() {
        let sun = Vec3::new(0.4, -0.8, -0.3).normalize();
        let mut compared = 0;
        for turn in 0..40 {
            let (seen, camera) = seen([1.0 - 0.1 * turn as f64, 1.6, 2.0], 0.37 * turn as f64);
            let cascades = fit(sun, &house(), &seen, SIZE);
            for (i, matrix) in cascades.iter().enumerate() {
                // The frustum up to a distance in proportion to the width.
                let far = 0.9 * 0.5 * width(matrix) / seen.tan;
                for [x, y, d] in [[1., 1., 1.], [0., 1., 1.], [1., 0., 1.], [0., 0., 1.], [0.5, 0.5, 0.01]] {
                    let ray = camera.direction(640.0 * x, 360.0 * y, 640, 360);
                    let place = camera.eye + ray * (far * d / ray.dot(camera.forward));
                    let [low, high] = house().all;
                    if place.cmplt(low).any() || place.cmpgt(high).any() {
                        continue;
                    }
                    compared += 1;
                    let clip = *matrix * place.extend(1.0);
                    assert!(clip.x.abs().max(clip.y.abs()) < 0.98, "{turn}, cascade {i}: {place} at {clip}");
                }
            }
            for corner in 0..8 {
                let at = |axis: usize| house().all[(corner >> axis) & 1][axis];
                let clip = cascades[2] * Vec3::new(at(0), at(1), at(2)).extend(1.0);
                assert!(clip.x.abs().max(clip.y.abs()) < 1.0 && (0.0..=1.0).contains(&clip.z));
            }
            let widths = [0, 1].map(|i| width(&cascades[i + 1]) / width(&cascades[i]));
            assert!(widths.iter().all(|ratio| (ratio - 3.0).abs() < 1e-3), "{widths:?}");
        }
        assert!(compared > 200, "{compared}");
    }

    #[test]
    fn texels_keep_their_places_while_the_camera_turns() {
        let sun = Vec3::new(0.4, -0.8, -0.3).normalize();
        let texels = |matrix: &Mat4| (*matrix * Vec3::new(0.3, 1.1, -0.7).extend(1.0)).truncate() * 512.0;
        let first = fit(sun, &house(), &seen([1.0, 1.6, 2.0], 0.0).0, SIZE);
        let mut last = first;
        let mut moves = 0;
        for turn in 1..200 {
            let cascades = fit(sun, &house(), &seen([1.0, 1.6, 2.0], 0.01 * turn as f64).0, SIZE);
            for (now, before) in cascades.iter().zip(&first) {
                let off = texels(now) - texels(before);
                let off = off.truncate() - off.truncate().round();
                assert!(off.length() < 0.02, "{turn}: {off} of a texel");
            }
            moves += cascades.iter().zip(&last).filter(|(a, b)| a != b).count();
            last = cascades;
        }
        // Two radians: a few steps, not one per frame.
        assert!((5..60).contains(&moves), "{moves}");
    }

    #[test]
    fn maps_are_as_fine_as_the_picture_and_within_their_budget() {
        assert_eq!(
            [size(1, 720, 512), size(1, 160, 512), size(1, 160, 2048), size(2, 720, 512)],
            [2048, 512, 2048, 1024]
        );
        assert!((1..60).all(|suns| size(suns, 2160, 512) == 256
            || u64::from(size(suns, 2160, 512)).pow(2) * 12 * u64::from(suns) <= BUDGET));
    }
}
