//! An environment in ever fewer pixels, for lobes of any width: filtered importance sampling (Křivánek and Colbert 2008).
//!
//! A sample of a lobe stands for a solid angle, and is read where pixels are about that large. The viewer's sky texture has
//! the same levels.

use super::Environment;
use crate::elementary::Elementary;
use glam::Vec3;
use std::f32::consts::TAU;

/// Most pixels in a row of the finest level.
pub const MIPS_WIDTH: u32 = 512;

/// Levels of an environment, each of half the width and height of the one before.
#[derive(Clone, Debug, PartialEq)]
pub struct EnvironmentMips {
    /// The finest first.
    pub levels: Vec<Environment>,
}

impl EnvironmentMips {
    /// Makes the levels of an environment, down to a row of two pixels.
    pub fn new(environment: &Environment) -> Self {
        let mut levels = vec![environment.coarse(MIPS_WIDTH)];
        while let Some(last) = levels.last().filter(|last| last.width > 2) {
            let next = last.coarse((last.width / 2).max(2));
            levels.push(next);
        }
        Self { levels }
    }

    /// Level whose pixels have this solid angle at the horizon, sr.
    pub fn level_of(&self, solid_angle: f32) -> f32 {
        let width = TAU / self.levels.first().map_or(1.0, |level| level.width as f32);
        0.5 * (solid_angle / (width * width)).max(1e-20).logarithm2()
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
        assert_eq!(mips.levels.last().map(|level| level.width), Some(3).or(Some(2)));
        for level in &mips.levels {
            let ratio = level.energy() / environment.energy();
            assert!((ratio - 1.0).abs().max_element() < 0.02, "{}: {ratio}", level.width);
        }
        let even = EnvironmentMips::new(&Environment::constant(Vec3::ONE));
        for level in [-3.0, 0.5, 9.0] {
            assert!(even.radiance(stream.sphere(), level).distance(Vec3::ONE) < 1e-6);
        }
    }

    #[test]
    fn the_level_of_a_pixel_is_the_level_with_pixels_that_large() {
        let mips =
            EnvironmentMips::new(&Environment { width: 64, height: 32, pixels: vec![Vec3::ONE; 2048] });
        for (level, width) in [(0.0, 64.0), (2.0, 16.0), (-1.0, 128.0)] {
            let side = TAU / width;
            assert!((mips.level_of(side * side) - level).abs() < 1e-4);
        }
    }
}
