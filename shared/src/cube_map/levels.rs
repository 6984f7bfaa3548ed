//! Radiance of a cube map at several widths: each level has half the texels along an edge, and means of four.

use super::cube::Cube;
use glam::{Vec3, Vec4};

/// Levels, finest first. Texels have radiance times coverage, and coverage: the share that is no sky.
#[derive(Clone, Debug)]
pub struct Levels {
    levels: Vec<(Cube, Vec<Vec4>)>,
}

impl Levels {
    /// Blurs a cube; its side is a power of two.
    pub fn new(cube: Cube, texels: Vec<Vec4>) -> Self {
        let mut levels = vec![(cube, texels)];
        while let Some((fine, texels)) = levels.last().filter(|(cube, _)| cube.side > 1) {
            let coarse = Cube { side: fine.side / 2 };
            let mut sums = vec![(Vec4::ZERO, 0.0f32); coarse.texels()];
            for (i, texel) in texels.iter().enumerate() {
                let direction = fine.direction(i);
                let (sum, whole) = &mut sums[coarse.nearest(direction)];
                let solid_angle = fine.solid_angle(direction);
                *sum += *texel * solid_angle;
                *whole += solid_angle;
            }
            levels.push((coarse, sums.into_iter().map(|(sum, whole)| sum / whole).collect()));
        }
        Self { levels }
    }

    /// Radiance times coverage, and coverage, in a unit direction, over about this solid angle, sr.
    pub fn at(&self, direction: Vec3, solid_angle: f32) -> Vec4 {
        let own = self.levels.first().map_or(1.0, |(cube, _)| cube.solid_angle(direction));
        let last = (self.levels.len() - 1) as f32;
        let level = (0.5 * (solid_angle / own).log2()).clamp(0.0, last);
        let (low, part) = (level.floor(), level.fract());
        let of = |level: f32| {
            let (cube, texels) = &self.levels[level as usize];
            cube.around(direction).iter().map(|(texel, weight)| texels[*texel] * *weight).sum::<Vec4>()
        };
        let fine = of(low);
        if part > 0.0 { fine.lerp(of(low + 1.0), part) } else { fine }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn an_even_cube_is_even_at_every_width() {
        let cube = Cube { side: 16 };
        let value = Vec4::new(0.5, 1.0, 2.0, 0.75);
        let levels = Levels::new(cube, vec![value; cube.texels()]);
        let texels: usize = levels.levels.iter().map(|(_, texels)| texels.len()).sum();
        assert_eq!(texels, 6 * (256 + 64 + 16 + 4 + 1));
        let mut stream = Stream::new(1, 5);
        for _ in 0..200 {
            let found = levels.at(stream.sphere(), 12.0 * stream.unit().powi(4));
            assert!(found.distance(value) < 1e-5, "{found}");
        }
    }

    #[test]
    fn wide_levels_keep_the_light_of_the_sphere() {
        let cube = Cube { side: 32 };
        let of = |i: usize| Vec4::splat(cube.direction(i).x.max(0.0));
        let levels = Levels::new(cube, (0..cube.texels()).map(of).collect());
        let (coarsest, texels) = levels.levels.last().unwrap();
        let mean: f32 = (0..6).map(|i| texels[i].x * coarsest.solid_angle(coarsest.direction(i))).sum();
        let whole: f32 = (0..6).map(|i| coarsest.solid_angle(coarsest.direction(i))).sum();
        // The mean of a clamped cosine over the sphere is a quarter.
        assert!((mean / whole - 0.25).abs() < 2e-3, "{}", mean / whole);
    }
}
