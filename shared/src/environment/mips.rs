//! An environment in ever fewer pixels, for lobes of any width: filtered importance sampling (Křivánek and Colbert 2008).
//!
//! A sample of a lobe stands for a solid angle, and is read from the level that is blurred over about as much. Blurs are round
//! on the sphere and wider than a pixel: means over pixels alone would show the pixels' pattern around a small bright lamp.

use super::Environment;
use crate::elementary::Elementary;
use glam::Vec3;
use std::f32::consts::TAU;

/// Most pixels in a row of the finest level.
pub const MIPS_WIDTH: u32 = 512;

/// Pixels that the blur of a level spreads over.
pub const PIXELS: f32 = 8.0;
/// Standard deviation of the blur of a level, in its pixels at the horizon.
const DEVIATION: f32 = 1.4;
/// Reach of the blur, pixels.
const REACH: i64 = 4;

/// Levels of an environment, each of half the width and height of the one before.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentMips {
    /// The finest first.
    pub levels: Vec<Environment>,
}

impl EnvironmentMips {
    /// Makes the levels of an environment, down to a row of two or three pixels. The finest is not blurred.
    pub fn new(environment: &Environment) -> Self {
        let mut levels = vec![environment.coarse(MIPS_WIDTH)];
        while let Some(last) = levels.last().filter(|last| last.width > 3) {
            let next = last.coarse(last.width / 2);
            levels.push(next);
        }
        for level in levels.iter_mut().skip(1) {
            *level = blurred(level);
        }
        Self { levels }
    }

    /// Level that is blurred over this solid angle, sr: that of [`PIXELS`] pixels at the horizon.
    pub fn level_of(&self, solid_angle: f32) -> f32 {
        let width = TAU / self.levels.first().map_or(1.0, |level| level.width as f32);
        0.5 * (solid_angle / (PIXELS * width * width)).max(1e-20).logarithm2()
    }

    /// Radiance from a unit direction of environment space at a level, between the two nearest, W/(sr m²).
    pub fn radiance(&self, direction: Vec3, level: f32) -> Vec3 {
        let level = level.max(0.0).min((self.levels.len() - 1) as f32);
        let fine = level as usize;
        let at = |level: usize| self.levels.get(level).map(|picture| picture.radiance(direction));
        let (fine, coarse, share) = (at(fine).unwrap_or(Vec3::ZERO), at(fine + 1), level - fine as f32);
        coarse.map_or(fine, |coarse| fine.lerp(coarse, share))
    }
}

/// Blurs by a Gaussian of the angle.
fn blurred(environment: &Environment) -> Environment {
    let (width, height) = (i64::from(environment.width), i64::from(environment.height));
    let deviation = DEVIATION * TAU / environment.width as f32;
    let mut pixels = Vec::with_capacity(environment.pixels.len());
    for y in 0..height {
        let here = environment.direction(0, y as u32);
        // By row, the weights of columns to the right, which are those to the left.
        let mut rows = Vec::new();
        for row in (y - REACH).max(0)..=(y + REACH).min(height - 1) {
            let solid_angle = environment.solid_angle(row as u32) as f32;
            let mut weights = Vec::new();
            for column in 0..=width / 2 {
                let chord = here.distance_squared(environment.direction(column as u32, row as u32));
                let weight = solid_angle * (-0.5 * chord / (deviation * deviation)).exponential();
                if weight < 1e-4 * solid_angle {
                    break;
                }
                weights.push(weight);
            }
            rows.push((row as u32, weights));
        }
        let of_row = |weights: &[f32]| -> f32 {
            let both = |(column, w): (usize, &f32)| {
                if column == 0 || 2 * column as i64 == width { *w } else { 2.0 * w }
            };
            weights.iter().enumerate().map(both).sum()
        };
        let total: f32 = rows.iter().map(|(_, weights)| of_row(weights)).sum();
        for x in 0..width {
            let mut sum = Vec3::ZERO;
            for (row, weights) in &rows {
                for (column, weight) in (0i64..).zip(weights) {
                    sum += environment.at((x + column).rem_euclid(width) as u32, *row) * *weight;
                    if column != 0 && 2 * column != width {
                        sum += environment.at((x - column).rem_euclid(width) as u32, *row) * *weight;
                    }
                }
            }
            pixels.push(sum / total);
        }
    }
    Environment { pixels, ..*environment }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn levels_keep_the_energy_and_an_even_sky_stays_even() {
        let mut stream = Stream::new(1, 2);
        let pixels = (0..100 * 50).map(|_| stream.sphere().abs()).collect();
        let environment = Environment { width: 100, height: 50, pixels };
        let mips = EnvironmentMips::new(&environment);
        assert_eq!(mips.levels.last().map(|level| level.width), Some(3));
        for level in &mips.levels {
            let ratio = level.energy() / environment.energy();
            assert!((ratio - 1.0).abs().max_element() < 0.03, "{}: {ratio}", level.width);
        }
        let even = EnvironmentMips::new(&Environment::constant(Vec3::ONE));
        for level in [-3.0, 0.5, 9.0] {
            assert!(even.radiance(stream.sphere(), level).distance(Vec3::ONE) < 1e-6);
        }
    }

    #[test]
    fn a_level_is_blurred_over_so_many_of_its_pixels() {
        let mips =
            EnvironmentMips::new(&Environment { width: 64, height: 32, pixels: vec![Vec3::ONE; 2048] });
        for (level, width) in [(0.0, 64.0), (2.0, 16.0), (-1.0, 128.0)] {
            let side = TAU / width;
            assert!((mips.level_of(PIXELS * side * side) - level).abs() < 1e-4);
        }
    }
}
