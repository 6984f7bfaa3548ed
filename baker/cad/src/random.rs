//! Random numbers for tests: SplitMix64 (Steele, Lea and Flood 2014).

use crate::frame::Frame;
use glam::{DVec2, DVec3};
use rebounce_shared::elementary::Elementary;
use std::f64::consts::TAU;

/// A generator.
pub(crate) struct SplitMix(pub(crate) u64);

impl SplitMix {
    /// From 0 to 1.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// From `low` to `high`.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// In a rectangle.
    pub(crate) fn point(&mut self, low: DVec2, high: DVec2) -> DVec2 {
        DVec2::new(self.between(low.x, high.x), self.between(low.y, high.y))
    }

    /// In a cube about the origin with this half side.
    pub(crate) fn place(&mut self, half: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| self.between(-half, half)))
    }

    /// Coordinates from -1 to 1.
    pub(crate) fn vector(&mut self) -> DVec3 {
        self.place(1.0)
    }

    /// A frame near the origin.
    pub(crate) fn frame(&mut self) -> Frame {
        let origin = self.between(0.0, 3.0) * self.direction();
        Frame::new(origin, self.direction(), self.direction()).unwrap()
    }

    /// On the unit sphere.
    pub(crate) fn direction(&mut self) -> DVec3 {
        let z = self.between(-1.0, 1.0);
        let (sine, cosine) = self.between(0.0, TAU).sine_cosine();
        ((1.0 - z * z).sqrt() * DVec2::new(cosine, sine)).extend(z)
    }
}
