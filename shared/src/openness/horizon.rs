//! Openness of a pixel from the depth buffer: ground-truth ambient occlusion (Jiménez et al. 2016, Eq. 5 to 10). Over each
//! of a few slices through the eye the horizon is looked for on both sides; between the horizons the cosine is integrated
//! in closed form. openness.wgsl does the same; a test holds the two together.

use super::open;
use glam::Vec3;

/// Slices of the hemisphere. They are the same in all pixels: noise that a filter must take out would shimmer.
pub const SLICES: u32 = 4;
/// Places looked at on each side of a slice.
pub const STEPS: u32 = 3;

/// A picture's depth: what [`horizon`] looks at.
pub struct View<'a> {
    /// The eye, local space.
    pub eye: Vec3,
    /// Unit vectors to the right, to the top and into the picture.
    pub axes: [Vec3; 3],
    /// Pixels across a unit of length at distance 1.
    pub pixels_per_unit: f32,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// The local position that a pixel shows; `None` where it shows nothing.
    pub position: &'a dyn Fn(u32, u32) -> Option<Vec3>,
}

/// Openness of a pixel that shows this place, with its unit normal and a reach in scene units.
pub fn horizon(view: &View<'_>, pixel: [u32; 2], position: Vec3, normal: Vec3, reach: f32) -> f32 {
    let [right, up, forward] = view.axes;
    let to_eye = (view.eye - position).normalize();
    let ahead = (position - view.eye).dot(forward);
    let across = reach * view.pixels_per_unit / ahead;
    let mut sum = 0.0;
    for slice in 0..SLICES {
        let angle = std::f32::consts::PI * slice as f32 / SLICES as f32;
        let (sin, cos) = angle.sin_cos();
        // Rows run down.
        let along = right * cos - up * sin;
        let axis = along.cross(to_eye).normalize();
        let tangent = to_eye.cross(axis);
        let projected = normal - axis * normal.dot(axis);
        let length = projected.length().max(1e-6);
        let tilt = projected.dot(tangent).atan2(projected.dot(to_eye));
        for side in [-1.0f32, 1.0] {
            // The horizon of the surface itself.
            let own = (tilt + side * std::f32::consts::FRAC_PI_2).cos();
            let mut highest = own;
            for step in 1..=STEPS {
                let share = step as f32 / STEPS as f32;
                let offset = side * across * share * share;
                let at = [pixel[0] as f32 + 0.5 + cos * offset, pixel[1] as f32 + 0.5 + sin * offset];
                let [x, y] = at.map(|x| x.floor());
                if x < 0.0 || y < 0.0 || x >= view.size[0] as f32 || y >= view.size[1] as f32 {
                    continue;
                }
                let Some(other) = (view.position)(x as u32, y as u32) else { continue };
                let offset = other - position;
                let distance = offset.length().max(1e-6 * reach);
                let height = offset.dot(to_eye) / distance;
                highest = highest.max(height + (own - height) * open(distance / reach));
            }
            let horizon = side * highest.clamp(-1.0, 1.0).acos();
            sum += length * 0.25 * (tilt.cos() + 2.0 * horizon * tilt.sin() - (2.0 * horizon - tilt).cos());
        }
    }
    (sum / SLICES as f32).clamp(0.0, 1.0)
}
