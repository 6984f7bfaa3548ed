//! Cosines of a surface over the directions of a bin.
//!
//! A bin is a disc here: over it the cosine to a normal is linear. The antiradiance paper takes the cosine of the bin's
//! middle; at the horizon of a surface bins have directions of both sides, and the cosine of the middle is of one alone.

use super::bins::Bins;
use crate::elementary::Elementary;
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

/// Means over a bin, for a surface with a normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct BinCosines {
    /// Mean of max(0, n · ω): light leaves with it.
    pub front: f32,
    /// Mean of max(0, −n · ω): light comes with it; ω is the way that it goes.
    pub back: f32,
    /// Share of the bin's directions with n · ω < 0: those of light that comes to the front.
    pub share: f32,
}

impl BinCosines {
    /// Those of a bin whose middle has this `cosine`; `sine` is that of the bin's half angle.
    pub fn new(cosine: f32, sine: f32) -> Self {
        let slope = sine * (1.0 - cosine * cosine).max(0.0).sqrt();
        if cosine.abs() >= slope {
            let front = cosine.max(0.0);
            let back = (-cosine).max(0.0);
            return Self { front, back, share: if cosine < 0.0 { 1.0 } else { 0.0 } };
        }
        let at = cosine / slope;
        let round = (1.0 - at * at).max(0.0).sqrt();
        let before = 0.5 + FRAC_1_PI * (at * round + at.arc_sine());
        let front = cosine * before + slope * (2.0 / 3.0) * FRAC_1_PI * round * round * round;
        Self { front: front.max(0.0), back: (front - cosine).max(0.0), share: 1.0 - before }
    }

    /// Mean of −n · ω over the directions that come to the front; zero where there are none.
    pub fn arriving(&self) -> f32 {
        if self.share > 0.0 { self.back / self.share } else { 0.0 }
    }

    /// Mean of |n · ω|.
    pub fn both(&self) -> f32 {
        self.front + self.back
    }
}

/// The factor that makes the integral of cosines over all bins that of a hemisphere, π.
pub fn normalisation(bins: &Bins, normal: Vec3) -> f32 {
    let sine = bins.sine();
    let front: f32 = bins.directions.iter().map(|way| BinCosines::new(normal.dot(*way), sine).front).sum();
    PI / (front * bins.solid_angle()).max(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn means_are_those_of_samples_on_the_disc() {
        let (sine, count) = (0.2f32, 100_000u64);
        for cosine in [-0.9f32, -0.1, -0.02, 0.0, 0.05, 0.15, 0.5] {
            let found = BinCosines::new(cosine, sine);
            let slope = sine * (1.0 - cosine * cosine).sqrt();
            let mut stream = Stream::new(3, 4);
            let (mut front, mut back, mut share) = (0.0f64, 0.0f64, 0.0f64);
            for _ in 0..count {
                let place = loop {
                    let place = 2.0 * stream.square() - 1.0;
                    if place.length() < 1.0 {
                        break place;
                    }
                };
                let at = cosine + slope * place.x;
                front += f64::from(at.max(0.0));
                back += f64::from((-at).max(0.0));
                share += f64::from(u8::from(at < 0.0));
            }
            for (found, sum) in [(found.front, front), (found.back, back), (found.share, share)] {
                assert!((f64::from(found) - sum / count as f64).abs() < 0.005, "{cosine}: {found}");
            }
        }
    }

    #[test]
    fn normals_along_axes_need_no_correction_and_others_little() {
        for count in [128, 512] {
            let bins = Bins::new(count);
            for normal in [Vec3::X, Vec3::Y, Vec3::NEG_Z, Vec3::ONE.normalize(), Vec3::new(0.6, 0.8, 0.0)] {
                assert!((normalisation(&bins, normal) - 1.0).abs() < 0.02, "{normal}");
            }
        }
    }
}
