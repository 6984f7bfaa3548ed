//! An environment as surfaces reflect it: without its sun, which is a lamp.

use super::mips::{EnvironmentMips, MIPS_WIDTH};
use super::picture::band;
use super::{Environment, direction_at, environment_from_world, extract_sun};
use crate::harmonics::{COUNT, Coefficients, evaluate};
use glam::Vec3;
use std::sync::{Arc, OnceLock};

/// Most pixels in a row from which coefficients are projected.
const PROJECTED: u32 = 128;

/// Rows of samples of an environment, at least: pixels of small pictures are divided.
const ROWS: u32 = 64;

/// Returns the [coefficients](crate::harmonics) of an environment's radiance, environment space: ∫ L y_i dω.
pub fn project(environment: &Environment) -> Coefficients {
    let mut sums = [Vec3::ZERO; COUNT];
    let parts = ROWS.div_ceil(environment.height);
    let (columns, rows) = (environment.width * parts, environment.height * parts);
    for row in 0..rows {
        let (top, bottom) = (f64::from(row) / f64::from(rows), f64::from(row + 1) / f64::from(rows));
        let solid_angle = band(top, bottom) / f64::from(columns);
        for column in 0..columns {
            let direction = direction_at(
                (f64::from(column) + 0.5) / f64::from(columns),
                (f64::from(row) + 0.5) / f64::from(rows),
            );
            let radiance = environment.at(column / parts, row / parts) * solid_angle as f32;
            sums.iter_mut().zip(evaluate(direction)).for_each(|(sum, y)| *sum += radiance * y);
        }
    }
    sums
}

/// Reflected form of an environment, made at the first use.
#[derive(Clone, Debug)]
pub struct Reflection {
    picture: Arc<Environment>,
    parts: OnceLock<(EnvironmentMips, Box<Coefficients>)>,
}

impl Reflection {
    /// Keeps the picture; nothing is computed yet.
    pub fn new(picture: Arc<Environment>) -> Self {
        Self { picture, parts: OnceLock::new() }
    }

    fn parts(&self) -> &(EnvironmentMips, Box<Coefficients>) {
        self.parts.get_or_init(|| {
            let (rest, _) = extract_sun(&self.picture.coarse(2 * MIPS_WIDTH));
            (EnvironmentMips::new(&rest), Box::new(project(&rest.coarse(PROJECTED))))
        })
    }

    /// The picture without its sun, at several widths.
    pub fn mips(&self) -> &EnvironmentMips {
        &self.parts().0
    }

    /// Coefficients of its radiance, environment space.
    pub fn coefficients(&self) -> &Coefficients {
        &self.parts().1
    }
}

/// An environment as it is reflected: without its sun, which is a lamp.
#[derive(Clone, Debug)]
pub struct ReflectedSky<'a> {
    /// Radiance, at several widths.
    pub mips: &'a EnvironmentMips,
    /// Rotation about the y axis, degrees.
    pub rotation_deg: f32,
    /// Factor, linear RGB.
    pub factor: Vec3,
}

impl ReflectedSky<'_> {
    /// Radiance from a unit direction of world space, over about this solid angle, sr; W/(sr m²).
    pub fn radiance(&self, direction: Vec3, solid_angle: f32) -> Vec3 {
        let level = self.mips.level_of(solid_angle);
        self.factor * self.mips.radiance(environment_from_world(direction, self.rotation_deg), level)
    }
}

/// Returns the radiance of several skies from a unit direction of world space, over about this solid angle, sr.
pub fn of_skies(skies: &[ReflectedSky<'_>], direction: Vec3, solid_angle: f32) -> Vec3 {
    skies.iter().map(|sky| sky.radiance(direction, solid_angle)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::environment::world_from_environment;
    use crate::harmonics::rotation::Rotation;
    use crate::harmonics::value;
    use crate::random::Stream;
    use glam::Mat3;
    use std::f32::consts::TAU;

    #[test]
    fn an_environment_turned_by_its_picture_is_the_turned_coefficients() {
        let mut stream = Stream::new(8, 2);
        let pixels = (0..64 * 32).map(|_| stream.sphere().abs()).collect();
        let environment = Environment { width: 64, height: 32, pixels };
        let still = project(&environment);
        // Half a turn of the picture is a shift of its columns.
        let shifted = |x: u32, y: u32| environment.at((x + 32) % 64, y);
        let pixels = (0..64 * 32).map(|i| shifted(i % 64, i / 64)).collect();
        let half = project(&Environment { pixels, ..environment.clone() });
        let turn = |deg: f32| {
            Mat3::from_cols_array_2d(
                &[Vec3::X, Vec3::Y, Vec3::Z].map(|axis| world_from_environment(axis, deg).to_array()),
            )
        };
        let turned = Rotation::new(turn(180.0)).apply(&still);
        assert!(turned.iter().zip(&half).all(|(a, b)| a.distance(*b) < 1e-4));
        let quarter = Rotation::new(turn(90.0)).apply(&still);
        for _ in 0..20 {
            let direction = stream.sphere();
            let expected = value(&still, environment_from_world(direction, 90.0));
            assert!(value(&quarter, direction).distance(expected) < 1e-4);
        }
    }

    #[test]
    fn even_pictures_of_any_size_have_one_coefficient() {
        for (width, height) in [(2, 1), (9, 5), (128, 64)] {
            let pixels = vec![Vec3::ONE; (width * height) as usize];
            let found = project(&Environment { width, height, pixels });
            assert!((found[0].x - (2.0 * TAU).sqrt()).abs() < 1e-4, "{width}: {}", found[0]);
            assert!(found[1..].iter().all(|c| c.length() < 2e-3), "{width}");
        }
    }
}
