//! Rays in the picture: a ray is followed over the pixels that the camera sees, a pixel a step, until it passes behind what is
//! there (McGuire and Mara, *Efficient GPU Screen-Space Ray Tracing*, 2014). What the camera does not see is not found.

use super::ReflectionView;
use super::cost::Cost;
use crate::geometry::{Hit, Ray, Surfaces};
use crate::random::Stream;
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use rebounce_shared::camera::CameraFrame;

/// Thickness of what a pixel shows, of its depth: a ray farther behind has passed.
const THICK: f32 = 0.03;
/// Most pixels of a ray.
const MOST_STEPS: u32 = 512;
/// Estimates of the light of a pixel.
const SAMPLES: u64 = 16;
/// Least depth, of the depth of the ray's origin.
const NEAREST: f32 = 0.01;

/// A visible surface.
#[derive(Clone, Copy, Debug)]
struct ScreenPixel {
    /// Along the camera's axis; infinite without a surface.
    depth: f32,
    normal: Vec3,
    radiance: Vec3,
}

/// A picture with the depth of its pixels.
pub(super) struct Screen {
    frame: CameraFrame,
    size: [u32; 2],
    pixels: Vec<ScreenPixel>,
}

impl Screen {
    /// Takes the picture; `radiance` is that of a hit against a ray in a direction.
    pub fn new<R>(view: &ReflectionView, surfaces: &impl Surfaces, radiance: &R) -> Self
    where
        R: Fn(&Hit, Vec3, &mut Stream) -> Vec3 + Sync,
    {
        let ReflectionView { frame, size: [width, height] } = *view;
        let pixel = |i: u32| {
            let (x, y) = ((i % width) as f32 + 0.5, (i / width) as f32 + 0.5);
            let direction = frame.direction(x, y, width, height);
            let ray = Ray { origin: frame.eye, direction, max_distance: f32::INFINITY, spread: 0.0 };
            let Some(hit) = surfaces.see(&ray, i) else {
                return ScreenPixel { depth: f32::INFINITY, normal: Vec3::ZERO, radiance: Vec3::ZERO };
            };
            let estimate = |sample| radiance(&hit, direction, &mut Stream::new(i.into(), sample));
            ScreenPixel {
                depth: (hit.position - frame.eye).dot(frame.forward),
                normal: hit.geometric_normal,
                radiance: (0..SAMPLES).map(estimate).sum::<Vec3>() / SAMPLES as f32,
            }
        };
        let pixels = (0..width * height).into_par_iter().map(pixel).collect();
        Self { frame, size: [width, height], pixels }
    }

    /// Place in the picture, pixels, and depth of a local position before the eye.
    fn project(&self, position: Vec3) -> (Vec2, f32) {
        let CameraFrame { eye, right, up, forward, tan_half_yfov } = self.frame;
        let from = position - eye;
        let depth = from.dot(forward);
        let scale = 0.5 * self.size[1] as f32 / (tan_half_yfov * depth);
        let middle = 0.5 * Vec2::new(self.size[0] as f32, self.size[1] as f32);
        (middle + scale * Vec2::new(from.dot(right), -from.dot(up)), depth)
    }

    fn pixel(&self, at: Vec2) -> Option<&ScreenPixel> {
        let [width, height] = self.size;
        let is_within = at.x >= 0.0 && at.y >= 0.0 && at.x < width as f32 && at.y < height as f32;
        is_within.then(|| &self.pixels[at.y as usize * width as usize + at.x as usize])
    }

    /// Radiance that arrives at a hit from a unit direction; `None` where the picture does not show it. `off` is a safe distance
    /// from surfaces.
    pub fn radiance(&self, hit: &Hit, direction: Vec3, off: f32, cost: &mut Cost) -> Option<Vec3> {
        let origin = hit.offset_origin(direction, off);
        let (first, depth) = self.project(origin);
        let ahead = direction.dot(self.frame.forward);
        // To the plane before the eye, or so far that the place in the picture does not change.
        let length = match ahead < 0.0 {
            true => (NEAREST - 1.0) * depth / ahead,
            false => 1e4 * depth,
        };
        let (last, far) = self.project(origin + length.min(1e4 * depth) * direction);
        let way = last - first;
        let count = way.abs().max_element().ceil();
        if !(count >= 1.0 && depth > 0.0 && far > 0.0) {
            return None;
        }
        // Inverse depth is linear in the picture.
        let (near, slope) = (1.0 / depth, (1.0 / far - 1.0 / depth) / count);
        let depth_at = |step: f32| 1.0 / (near + slope * step);
        for i in 1..=(count as u32).min(MOST_STEPS) {
            let step = i as f32;
            let pixel = self.pixel(first + way * (step / count))?;
            cost.steps += 1;
            let [before, after] = [depth_at(step - 0.5), depth_at((step + 0.5).min(count))];
            let (nearer, farther) = (before.min(after), before.max(after));
            let is_met = farther >= pixel.depth && nearer <= pixel.depth * (1.0 + THICK);
            // Not the back of what is seen.
            if is_met && pixel.normal.dot(direction) < 0.0 {
                return Some(pixel.radiance);
            }
        }
        None
    }
}
