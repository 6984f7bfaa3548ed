//! Importance sampling of an environment's picture by luminance (Pharr, Jakob, Humphreys: *Physically Based Rendering*, 4th
//! ed., 12.5).

use super::far::Environment;
use glam::{Vec2, Vec3};
use rebounce_shared::colour::luminance;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::environment::{self, direction_at, environment_from_world, world_from_environment};
use std::f32::consts::PI;
use std::sync::Arc;

/// A turned picture, with a table of its pixels' light.
pub struct EnvironmentMap {
    picture: Arc<environment::Environment>,
    rotation_deg: f32,
    factor: Vec3,
    /// Sums of the pixels' weights up to and including a pixel, row by row.
    sums: Vec<f64>,
}

impl EnvironmentMap {
    /// Prepares a picture, multiplied by a linear RGB factor.
    pub fn new(picture: Arc<environment::Environment>, rotation_deg: f32, factor: Vec3) -> Self {
        let (width, height) = (picture.width as i64, picture.height as i64);
        // Radiance is interpolated between pixels: a dark pixel beside a bright one is bright in part.
        let light = |x: i64, y: i64| -> f32 {
            let beside = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
            let of = |(dx, dy): (i64, i64)| {
                let (x, y) = ((x + dx).rem_euclid(width), (y + dy).clamp(0, height - 1));
                luminance(picture.pixels[(y * width + x) as usize].max(Vec3::ZERO))
            };
            beside.map(of).sum::<f32>() / 9.0
        };
        let mut total = 0.0;
        let mut sums = Vec::with_capacity((width * height) as usize);
        for y in 0..height {
            let solid = picture.solid_angle(y as u32);
            for x in 0..width {
                total += f64::from(light(x, y)) * solid;
                sums.push(total);
            }
        }
        Self { picture, rotation_deg, factor, sums }
    }

    fn weight(&self, pixel: usize) -> f64 {
        self.sums[pixel] - if pixel > 0 { self.sums[pixel - 1] } else { 0.0 }
    }

    fn total(&self) -> f64 {
        self.sums.last().copied().unwrap_or(0.0)
    }

    /// Density over the picture's width and height, both 1, divided by the sine of the polar angle and by 2π².
    fn density_of(&self, pixel: usize, sine: f32) -> f32 {
        let share = self.weight(pixel) / self.total() * self.sums.len() as f64;
        share as f32 / (2.0 * PI * PI * sine.max(1e-6))
    }
}

impl Environment for EnvironmentMap {
    fn radiance(&self, direction: Vec3) -> Vec3 {
        self.factor * self.picture.radiance(environment_from_world(direction, self.rotation_deg))
    }

    fn sample(&self, square: Vec2) -> (Vec3, f32) {
        if self.total() <= 0.0 {
            return (Vec3::Y, 0.0);
        }
        // The first coordinate chooses the pixel, and what is left of it the place within.
        let at = f64::from(square.x) * self.total();
        let pixel = self.sums.partition_point(|sum| *sum <= at).min(self.sums.len() - 1);
        let before = self.sums[pixel] - self.weight(pixel);
        let within = ((at - before) / self.weight(pixel)).clamp(0.0, 1.0) as f32;
        let (width, height) = (self.picture.width as usize, self.picture.height as usize);
        let u = ((pixel % width) as f32 + within) / width as f32;
        let v = ((pixel / width) as f32 + square.y) / height as f32;
        let direction = direction_at(f64::from(u), f64::from(v));
        (world_from_environment(direction, self.rotation_deg), self.density_of(pixel, (PI * v).sine()))
    }

    fn density(&self, direction: Vec3) -> f32 {
        if self.total() <= 0.0 {
            return 0.0;
        }
        let d = environment_from_world(direction, self.rotation_deg);
        let (width, height) = (self.picture.width as usize, self.picture.height as usize);
        let u = d.z.arc_tangent2(d.x) / (2.0 * PI) + 0.5;
        let v = d.y.clamp(-1.0, 1.0).arc_cosine() / PI;
        let x = ((u * width as f32) as usize).min(width - 1);
        let y = ((v * height as f32) as usize).min(height - 1);
        self.density_of(y * width + x, (1.0 - d.y * d.y).max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    /// A picture with a bright spot on a dim gradient.
    fn map() -> EnvironmentMap {
        let pixel = |i: u32| {
            let (x, y) = (i % 32, i / 32);
            Vec3::splat(0.1 + 0.01 * x as f32 + if (x, y) == (20, 4) { 300.0 } else { 0.0 })
        };
        let picture =
            environment::Environment { width: 32, height: 16, pixels: (0..512).map(pixel).collect() };
        EnvironmentMap::new(Arc::new(picture), 40.0, Vec3::new(1.0, 0.5, 2.0))
    }

    #[test]
    fn samples_give_the_irradiance_of_the_picture() {
        let map = map();
        let mut stream = Stream::new(1, 4);
        let (n, normal) = (200_000, Vec3::new(0.2, 1.0, -0.4).normalize());
        let mut sums = [Vec3::ZERO; 2];
        for _ in 0..n {
            let (direction, density) = map.sample(stream.square());
            assert!((direction.length() - 1.0).abs() < 1e-4);
            let again = map.density(direction);
            // Rounding may put a sample into the neighbouring pixel.
            sums[0] += map.radiance(direction) * normal.dot(direction).max(0.0) / density / n as f32;
            let uniform = stream.sphere();
            sums[1] += map.radiance(uniform) * normal.dot(uniform).max(0.0) * 4.0 * PI / n as f32;
            assert!(again > 0.0);
        }
        assert!((sums[0] / sums[1] - 1.0).abs().max_element() < 0.05, "{} and {}", sums[0], sums[1]);
    }

    #[test]
    fn densities_integrate_to_one() {
        let map = map();
        let mut stream = Stream::new(1, 5);
        let n = 400_000;
        let sum: f32 = (0..n).map(|_| map.density(stream.sphere()) * 4.0 * PI / n as f32).sum();
        assert!((sum - 1.0).abs() < 0.05, "{sum}");
    }
}
