//! Equirectangular radiance.
//!
//! Environment space: the picture's middle lies towards +x, a quarter to its right +z, its top +y (as in three.js).
//! World space is environment space turned about +y by `rotation_deg`, from −z towards −x: counterclockwise seen from
//! above.

use crate::colour::luminance;
use crate::elementary::Elementary;
use glam::{DVec3, Vec3};
use std::f32::consts::{FRAC_1_PI, TAU};

/// Radiance from infinitely far, by direction: rows from the top, equidistant in angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Pixels in a row, 360°.
    pub width: u32,
    /// Rows, 180°.
    pub height: u32,
    /// `width · height` pixels: linear RGB, W/(sr m²).
    pub pixels: Vec<Vec3>,
}

/// Turns a direction of world space into environment space.
#[inline]
pub fn environment_from_world(direction: Vec3, rotation_deg: f32) -> Vec3 {
    turned(direction, rotation_deg.to_radians().sine_cosine())
}

/// Turns a direction about y by an angle, of which sine and cosine are given.
#[inline]
pub(super) fn turned(direction: Vec3, (sin, cos): (f32, f32)) -> Vec3 {
    Vec3::new(cos * direction.x - sin * direction.z, direction.y, sin * direction.x + cos * direction.z)
}

/// The inverse of [`environment_from_world`].
#[inline]
pub fn world_from_environment(direction: Vec3, rotation_deg: f32) -> Vec3 {
    environment_from_world(direction, -rotation_deg)
}

/// The direction at a place of the picture: 0 to 1 from the left, 0 to 1 from the top.
pub fn direction_at(u: f64, v: f64) -> Vec3 {
    direction_of(azimuth(u), polar(v))
}

/// Sine and cosine of the angle from +x towards +z at a place of the picture, 0 to 1 from the left.
pub(super) fn azimuth(u: f64) -> (f64, f64) {
    ((u - 0.5) * std::f64::consts::TAU).sine_cosine()
}

/// Sine and cosine of the angle from +y at a place of the picture, 0 to 1 from the top.
pub(super) fn polar(v: f64) -> (f64, f64) {
    (v * std::f64::consts::PI).sine_cosine()
}

/// The direction of an azimuth and a polar angle.
#[inline]
pub(super) fn direction_of((sin, cos): (f64, f64), (sin_polar, cos_polar): (f64, f64)) -> Vec3 {
    DVec3::new(sin_polar * cos, cos_polar, sin_polar * sin).as_vec3()
}

impl Environment {
    /// The same radiance from everywhere.
    pub fn constant(rgb: Vec3) -> Self {
        Self { width: 2, height: 1, pixels: vec![rgb; 2] }
    }

    /// Bilinear radiance from a unit direction of environment space, W/(sr m²). Wraps around in azimuth; within half a
    /// row of a pole it is that row's.
    pub fn radiance(&self, direction: Vec3) -> Vec3 {
        let azimuth = direction.z.arc_tangent2(direction.x);
        let column = (azimuth / TAU + 0.5) * self.width as f32 - 0.5;
        let row = direction.y.clamp(-1.0, 1.0).arc_cosine() * FRAC_1_PI * self.height as f32 - 0.5;
        // No `clamp`: its panic would bring the formatting of floats into the page's module.
        let (column, row) = (column.max(-0.5), row.max(0.0).min((self.height - 1) as f32));
        let (right, down) = (column - column.floor(), row - row.floor());
        let left = (column.floor() as i64).rem_euclid(i64::from(self.width)) as u32;
        let top = row as u32;
        let line = |y: u32| self.at(left, y).lerp(self.at((left + 1) % self.width, y), right);
        line(top).lerp(line((top + 1).min(self.height - 1)), down)
    }

    /// The pixel in column x from the left and row y from the top.
    #[inline]
    pub fn at(&self, x: u32, y: u32) -> Vec3 {
        self.pixels[y as usize * self.width as usize + x as usize]
    }

    /// Direction of a pixel's middle, environment space.
    pub fn direction(&self, x: u32, y: u32) -> Vec3 {
        direction_at(
            (f64::from(x) + 0.5) / f64::from(self.width),
            (f64::from(y) + 0.5) / f64::from(self.height),
        )
    }

    /// Solid angle of a pixel of a row, sr.
    pub fn solid_angle(&self, row: u32) -> f64 {
        let top = f64::from(row) / f64::from(self.height);
        let bottom = f64::from(row + 1) / f64::from(self.height);
        band(top, bottom) / f64::from(self.width)
    }

    /// Integral of the radiance over the sphere, W/m², RGB.
    pub fn energy(&self) -> DVec3 {
        self.integral(|_, _| 1.0)
    }

    /// Irradiance of a surface with a unit normal of environment space that sees half of the environment, W/m², RGB.
    pub fn irradiance(&self, normal: Vec3) -> Vec3 {
        self.integral(|x, y| f64::from(normal.dot(self.direction(x, y)).max(0.0))).as_vec3()
    }

    /// Integral of radiance times a weight of pixels over the sphere.
    pub(super) fn integral(&self, weight: impl Fn(u32, u32) -> f64) -> DVec3 {
        let row = |y: u32| -> DVec3 {
            let sum: DVec3 = (0..self.width).map(|x| self.at(x, y).as_dvec3() * weight(x, y)).sum();
            sum * self.solid_angle(y)
        };
        (0..self.height).map(row).sum()
    }

    /// Luminance of every pixel.
    pub(super) fn luminances(&self) -> Vec<f32> {
        self.pixels.iter().map(|&pixel| luminance(pixel)).collect()
    }

    /// The environment with at most `max_width` pixels in a row, its ratio kept: a box filter that weighs with solid
    /// angles, so the [`energy`](Self::energy) stays.
    pub fn reduced(&self, max_width: u32) -> Self {
        if self.width <= max_width.max(1) {
            return self.clone();
        }
        let width = max_width.max(1);
        let ratio = f64::from(width) / f64::from(self.width);
        let height = (f64::from(self.height) * ratio).round().max(1.0) as u32;
        self.resized(width, height)
    }

    /// The environment in at most so many columns, and half as many rows, of whole pixels: their means by solid angle.
    /// [`reduced`](Self::reduced) divides pixels, with more code than a page has room for.
    pub fn coarse(&self, columns: u32) -> Self {
        let (width, height) = (self.width.min(columns), self.height.min(columns / 2));
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for y in 0..height {
            for x in 0..width {
                let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
                for row in y * self.height / height..(y + 1) * self.height / height {
                    let solid_angle = self.solid_angle(row);
                    for column in x * self.width / width..(x + 1) * self.width / width {
                        sum += self.at(column, row).as_dvec3() * solid_angle;
                        weight += solid_angle;
                    }
                }
                pixels.push((sum / weight).as_vec3());
            }
        }
        Self { width, height, pixels }
    }

    /// The environment in another size, by the filter of [`reduced`](Self::reduced).
    pub(super) fn resized(&self, width: u32, height: u32) -> Self {
        let columns = overlaps(self.width, width, |from, to| to - from);
        let rows = overlaps(self.height, height, band);
        let mut pixels = Vec::with_capacity(width as usize * height as usize);
        for row in &rows {
            for column in &columns {
                let (mut sum, mut weight) = (DVec3::ZERO, 0.0);
                for &(y, tall) in row {
                    for &(x, wide) in column {
                        sum += self.at(x, y).as_dvec3() * (tall * wide);
                        weight += tall * wide;
                    }
                }
                pixels.push((sum / weight).as_vec3());
            }
        }
        Self { width, height, pixels }
    }
}

/// Solid angle of the band between two heights of the picture, 0 to 1 from the top; sr.
pub(super) fn band(top: f64, bottom: f64) -> f64 {
    // cos a − cos b, without the loss of digits near a pole.
    let half = std::f64::consts::FRAC_PI_2;
    2.0 * std::f64::consts::TAU * ((top + bottom) * half).sine() * ((bottom - top) * half).sine()
}

/// For each of `to` equal intervals of [0, 1]: those of `from` that it overlaps, with the size of the overlap.
fn overlaps(from: u32, to: u32, size: impl Fn(f64, f64) -> f64) -> Vec<Vec<(u32, f64)>> {
    // Bounds in units of 1 / (from · to), whole numbers.
    let (from, to) = (u64::from(from), u64::from(to));
    let scale = 1.0 / (from * to) as f64;
    let part = |i: u64| {
        let (first, last) = (i * from, (i + 1) * from);
        let overlap = |j: u64| {
            let (start, end) = (first.max(j * to), last.min((j + 1) * to));
            (j as u32, size(start as f64 * scale, end as f64 * scale))
        };
        (first / to..last.div_ceil(to)).map(overlap).collect()
    };
    (0..to).map(part).collect()
}

/// Radius in degrees of the disk on the sphere with a solid angle in sr.
pub(super) fn disk_radius_deg(solid_angle: f64) -> f64 {
    // 2π (1 − cos r) = 4π sin²(r / 2)
    2.0 * (solid_angle / (2.0 * std::f64::consts::TAU)).clamp(0.0, 1.0).sqrt().arc_sine().to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    pub(in crate::environment) fn noise(width: u32, height: u32) -> Environment {
        let mut stream = Stream::new(5, u64::from(width));
        let pixel = |_| Vec3::new(stream.unit(), stream.unit(), stream.unit().powi(8) * 40.0);
        Environment { width, height, pixels: (0..width * height).map(pixel).collect() }
    }

    /// One bright pixel.
    fn spot(x: u32, y: u32) -> Environment {
        let mut pixels = vec![Vec3::ZERO; 32 * 16];
        pixels[(y * 32 + x) as usize] = Vec3::ONE;
        Environment { width: 32, height: 16, pixels }
    }

    fn brightest(picture: &Environment, rotation_deg: f32) -> Vec3 {
        let light = |world| picture.radiance(environment_from_world(world, rotation_deg)).x;
        let mut stream = Stream::new(1, 1);
        (0..40_000).map(|_| stream.sphere()).max_by(|a, b| light(*a).total_cmp(&light(*b))).unwrap()
    }

    #[test]
    fn the_middle_is_x_a_quarter_to_the_right_z_and_the_top_y() {
        let pairs = [(15, 7, Vec3::X), (23, 7, Vec3::Z), (7, 7, -Vec3::Z), (0, 7, -Vec3::X)];
        for (x, y, direction) in pairs {
            assert!(brightest(&spot(x, y), 0.0).dot(direction) > 0.97, "{direction}");
        }
        assert!(direction_at(0.3, 0.0).distance(Vec3::Y) < 1e-6);
        let picture = noise(32, 16);
        for (x, y) in [(0, 0), (31, 15), (13, 8), (31, 3)] {
            let there = picture.radiance(picture.direction(x, y));
            assert!(there.distance(picture.at(x, y)) < 1e-3 * (1.0 + there.length()), "{x} {y}");
        }
    }

    #[test]
    fn rotation_goes_from_minus_z_towards_minus_x() {
        // The picture's −z comes to −x, its +x to −z.
        assert!(world_from_environment(-Vec3::Z, 90.0).distance(-Vec3::X) < 1e-6);
        assert!(world_from_environment(Vec3::X, 90.0).distance(-Vec3::Z) < 1e-6);
        assert!(brightest(&spot(15, 7), 90.0).dot(-Vec3::Z) > 0.97);
        let direction = Stream::new(2, 3).sphere();
        let back = environment_from_world(world_from_environment(direction, 37.0), 37.0);
        assert!(back.distance(direction) < 1e-6);
    }

    #[test]
    fn radiance_is_continuous_across_the_seam_and_constant_around_a_pole() {
        let picture = noise(32, 16);
        for y in [-0.9f32, -0.2, 0.3, 0.8] {
            let r = (1.0 - y * y).sqrt();
            let side = |z: f32| picture.radiance(Vec3::new(-r, y, z));
            assert!(side(1e-6).distance(side(-1e-6)) < 1e-2, "{y}");
        }
        let constant = Environment::constant(Vec3::new(1.0, 2.0, 3.0));
        let mut stream = Stream::new(3, 3);
        for _ in 0..100 {
            assert_eq!(constant.radiance(stream.sphere()), Vec3::new(1.0, 2.0, 3.0));
        }
        assert_eq!(picture.radiance(Vec3::Y).is_finite(), picture.radiance(-Vec3::Y).is_finite());
    }

    #[test]
    fn solid_angles_sum_to_the_sphere_and_a_constant_lights_with_pi() {
        let picture = noise(64, 32);
        let all: f64 = (0..32).map(|y| picture.solid_angle(y) * 64.0).sum();
        assert!((all - 4.0 * std::f64::consts::PI).abs() < 1e-12);
        let white = Environment { pixels: vec![Vec3::ONE; 64 * 32], ..picture };
        for normal in [Vec3::Y, Vec3::X, Vec3::new(0.6, 0.0, 0.8)] {
            assert!((white.irradiance(normal).x - std::f32::consts::PI).abs() < 0.01);
        }
    }

    #[test]
    fn reduction_keeps_the_energy() {
        let picture = noise(100, 50);
        for width in [99, 64, 50, 7, 1] {
            let small = picture.reduced(width);
            assert_eq!(small.width, width);
            let ratio = small.energy() / picture.energy();
            assert!((ratio - DVec3::ONE).abs().max_element() < 1e-6, "{width}: {ratio}");
        }
        assert_eq!(picture.reduced(100), picture);
        assert_eq!(picture.reduced(50).height, 25);
    }

    #[test]
    fn coarse_pixels_are_means_and_nothing_is_left_out() {
        let constant = Environment { width: 301, height: 150, pixels: vec![Vec3::ONE; 301 * 150] };
        let coarse = constant.coarse(128);
        assert_eq!((coarse.width, coarse.height), (128, 64));
        assert!(coarse.pixels.iter().all(|pixel| pixel.distance(Vec3::ONE) < 1e-6));
        let picture = noise(256, 128);
        let ratio = picture.coarse(64).energy() / picture.energy();
        assert!((ratio - DVec3::ONE).abs().max_element() < 1e-6, "{ratio}");
        assert_eq!(picture.coarse(256), picture);
        for at in [0, 300, 301 * 150 - 1] {
            let mut spot = Environment { pixels: vec![Vec3::ZERO; 301 * 150], ..constant.clone() };
            spot.pixels[at] = Vec3::ONE;
            assert_eq!(spot.coarse(128).pixels.iter().filter(|pixel| pixel.x > 0.0).count(), 1, "{at}");
        }
    }

    #[test]
    fn a_disk_has_the_solid_angle_of_its_radius() {
        assert!((disk_radius_deg(4.0 * std::f64::consts::PI) - 180.0).abs() < 1e-6);
        assert!((disk_radius_deg(6.8e-5) - 0.2666).abs() < 1e-3);
    }
}
