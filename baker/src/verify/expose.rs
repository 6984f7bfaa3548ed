//! Average of the samples of each pixel over a box of one pixel: stratified samples, one per cell of a square grid;
//! remaining samples anywhere in the pixel.

use crate::geometry::Ray;
use crate::io::picture::Picture;
use crate::random::Stream;
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;
use rebounce_shared::camera::CameraFrame;

/// Size, number of samples and seed of a rendering.
#[derive(Clone, Copy, Debug)]
pub struct Exposure {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Samples per pixel, at least 1.
    pub samples: u32,
    /// Seed of the random numbers; pictures of equal seed are identical at any thread count.
    pub seed: u64,
}

/// Renders a picture. `radiance` returns the linear RGB radiance along a ray, local space, with a random stream per
/// sample. `row_done` is called after each row, from any thread.
pub fn expose(
    camera: &CameraFrame,
    exposure: Exposure,
    radiance: impl Fn(&Ray, &mut Stream) -> Vec3 + Sync,
    row_done: impl Fn() + Sync,
) -> Picture {
    let [width, height] = exposure.size;
    let samples = exposure.samples.max(1);
    let side = samples.isqrt();
    let mut pixels = vec![Vec3::ZERO; width as usize * height as usize];
    pixels.par_chunks_mut(width.max(1) as usize).enumerate().for_each(|(y, row)| {
        for (x, pixel) in row.iter_mut().enumerate() {
            let index = (y as u64 * width as u64 + x as u64) * samples as u64;
            let mut sum = DVec3::ZERO;
            for s in 0..samples {
                let mut stream = Stream::new(exposure.seed, index + s as u64);
                let mut jitter = stream.square();
                if s < side * side {
                    jitter = (Vec2::new((s % side) as f32, (s / side) as f32) + jitter) / side as f32;
                }
                let direction = camera.direction(x as f32 + jitter.x, y as f32 + jitter.y, width, height);
                let ray = Ray { origin: camera.eye, direction, max_distance: f32::INFINITY, spread: 0.0 };
                sum += radiance(&ray, &mut stream).as_dvec3();
            }
            *pixel = (sum / samples as f64).as_vec3();
        }
        row_done();
    });
    Picture { width, height, pixels }
}
