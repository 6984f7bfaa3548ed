//! Random numbers as pure functions of seed and index: a bake does not depend on the thread count.

use crate::elementary::Elementary;
use glam::{Vec2, Vec3};

/// Mixes 64 bits (the finaliser of SplitMix64, Steele et al. 2014).
#[inline]
pub fn mix(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A number from 0 up to 1 out of 64 uniform bits.
#[inline]
pub fn unit(bits: u64) -> f32 {
    (bits >> 40) as f32 * (1.0 / (1u64 << 24) as f32)
}

/// A stream of random numbers named by a seed and an index.
#[derive(Clone, Debug)]
pub struct Stream(u64);

impl Stream {
    /// The stream `index` of `seed`.
    pub fn new(seed: u64, index: u64) -> Self {
        Self(mix(mix(seed) ^ index.wrapping_mul(0xd6e8_feb8_6659_fd93)))
    }

    /// 64 uniform bits.
    #[inline]
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        mix(self.0)
    }

    /// Uniform in [0, 1).
    #[inline]
    pub fn unit(&mut self) -> f32 {
        unit(self.bits())
    }

    /// Uniform in the unit square.
    #[inline]
    pub fn square(&mut self) -> Vec2 {
        Vec2::new(self.unit(), self.unit())
    }

    /// Uniform on the unit sphere.
    #[inline]
    pub fn sphere(&mut self) -> Vec3 {
        let u = self.square();
        let z = 1.0 - 2.0 * u.x;
        let r = (1.0 - z * z).max(0.0).sqrt();
        let (sin, cos) = (u.y * std::f32::consts::TAU).sine_cosine();
        Vec3::new(r * cos, r * sin, z)
    }

    /// Cosine-distributed on the hemisphere around a unit normal.
    #[inline]
    pub fn cosine_hemisphere(&mut self, normal: Vec3) -> Vec3 {
        // A uniform sphere that touches the surface from above (Shirley): cosine-distributed directions.
        (normal + 0.9999 * self.sphere()).normalize()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cosine_hemisphere_has_mean_cosine_two_thirds() {
        let mut stream = Stream::new(1, 2);
        let n = 100_000;
        let mean: f32 = (0..n).map(|_| stream.cosine_hemisphere(Vec3::Z).z).sum::<f32>() / n as f32;
        assert!((mean - 2.0 / 3.0).abs() < 0.005, "{mean}");
    }

    #[test]
    fn streams_differ_and_repeat() {
        assert_eq!(Stream::new(3, 4).bits(), Stream::new(3, 4).bits());
        assert_ne!(Stream::new(3, 4).bits(), Stream::new(3, 5).bits());
        assert_ne!(Stream::new(3, 4).bits(), Stream::new(4, 4).bits());
    }
}
