//! The directions of one hemispherical gather.
//!
//! Irradiance weighs directions by their cosine. They are drawn from a mixture,
//! `p(ω) = (2βz + 1 − β) / 2π` with z the cosine, so that grazing directions, where senders are small and near, are
//! not left to few rays. They come from the Fibonacci lattice – of R2, jittered strata and this
//! one it had the least error at every count from 256 to 4096 – sorted so that neighbours in the
//! list are neighbours on the hemisphere, and shifted per receiver.

use crate::random::mix;
use glam::{Vec2, Vec3, Vec3A};

/// Share β of the cosine-weighted directions.
const COSINE_SHARE: f32 = 0.8;

/// Points of the unit square, to be shifted and mapped to hemispheres.
#[derive(Clone, Debug)]
pub struct Directions {
    /// The first coordinate, and cosine and sine of the second one times 2π.
    square: Vec<Vec3>,
}

/// A direction to cast, and what it counts.
#[derive(Clone, Copy, Debug)]
pub struct Direction {
    /// Unit, local space.
    pub direction: Vec3A,
    /// Weight per ray, before the division by the sum of cosine times weight.
    pub weight: f32,
    /// Cosine to the normal.
    pub cosine: f32,
}

impl Directions {
    /// `count` directions.
    pub fn new(count: u32) -> Self {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let mut square: Vec<Vec2> = (0..count)
            .map(|i| {
                let (x, y) = ((i as f64 + 0.5) / count as f64, (i as f64 * GOLDEN).fract());
                Vec2::new(x as f32, y as f32)
            })
            .collect();
        // Rows of about square tiles, back and forth.
        let tiles = (count as f32).sqrt().ceil().max(1.0) / 2.0;
        let order = |p: &Vec2| {
            let row = (p.x * tiles) as u32;
            let column = (p.y * tiles) as u32;
            (row, if row.is_multiple_of(2) { column } else { u32::MAX - column })
        };
        square.sort_by_key(order);
        let mapped = |p: Vec2| {
            let (sin, cos) = (p.y * std::f32::consts::TAU).sin_cos();
            Vec3::new(p.x, cos, sin)
        };
        Self { square: square.into_iter().map(mapped).collect() }
    }

    /// Number of directions.
    pub fn len(&self) -> usize {
        self.square.len()
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.square.is_empty()
    }

    /// The directions around a unit normal, shifted by a hash of `name`.
    pub fn around(&self, normal: Vec3, name: u64) -> impl Iterator<Item = Direction> + '_ {
        let bits = mix(name);
        let shift = Vec2::new((bits >> 40) as f32, (bits >> 16 & 0xff_ffff) as f32) / (1u32 << 24) as f32;
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let (tangent, bitangent, normal) =
            (Vec3A::from(tangent), Vec3A::from(bitangent), Vec3A::from(normal));
        // A shift of the second coordinate turns the hemisphere.
        let (sin, cos) = (shift.y * std::f32::consts::TAU).sin_cos();
        let (tangent, bitangent) = (tangent * cos + bitangent * sin, bitangent * cos - tangent * sin);
        self.square.iter().map(move |p| {
            let x = p.x + shift.x;
            let x = if x >= 1.0 { x - 1.0 } else { x };
            const B: f32 = COSINE_SHARE;
            // The cosine's distribution function is βz² + (1 − β)z.
            let cosine = (((1.0 - B) * (1.0 - B) + 4.0 * B * x).sqrt() - (1.0 - B)) / (2.0 * B);
            let cosine = cosine.clamp(1e-4, 1.0);
            let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
            Direction {
                direction: tangent * (sine * p.y) + bitangent * (sine * p.z) + normal * cosine,
                weight: 2.0 / (2.0 * B * cosine + 1.0 - B),
                cosine,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mixture_integrates_cosine_and_tangent_exactly_enough() {
        for count in [256, 4096] {
            let directions = Directions::new(count);
            for name in 0..20 {
                let normal = Vec3::new(0.48, 0.6, -0.64);
                let (mut cosines, mut vector) = (0.0, Vec3A::ZERO);
                for d in directions.around(normal, name) {
                    assert!((d.direction.length() - 1.0).abs() < 1e-4);
                    cosines += d.cosine * d.weight / count as f32;
                    vector += d.direction * (d.weight / count as f32);
                }
                // ∫ ω dω / π over the hemisphere is the normal.
                assert!((cosines - 1.0).abs() < 0.01, "{cosines}");
                assert!((Vec3::from(vector) - normal).length() < 0.05, "{vector}");
            }
        }
    }
}
