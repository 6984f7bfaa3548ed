//! Openness: share of the hemisphere over a place left free by near surfaces (ambient obscurance; Zhukov et al., *An
//! Ambient Light Illumination Model*, 1998), and its effect on irradiance.
//!
//! Bounced irradiance between points is interpolated and lacks folds and contacts smaller than a support. Openness is
//! known at the points (section `OPEN`) and computable at every pixel: from short rays on the CPU, from horizons in
//! the depth buffer on the GPU ([`mod@horizon`], openness.wgsl). A pixel's irradiance is
//! `received(V) · Σ w_j E_j / received(V_j)`, with the weights `w_j` of the basis. The result equals plain
//! interpolation far from other surfaces, and wherever a pixel is as open as the points around it.
//!
//! `V = ∫ open(d / R) cos θ dω / π` with the distance `d` of the first surface and the reach `R`.

mod horizon;

pub use horizon::{SLICES, STEPS, View, horizon};

/// Maximum distance of occluding surfaces, relative to the support radius of the finest functions.
pub const REACH: f32 = 1.0;
/// Assumed reflectance of nearby surfaces.
pub const NEAR_ALBEDO: f32 = 0.8;
/// Lower bound of openness: smaller values would amplify noise and rounding.
pub const LEAST: f32 = 0.3;
/// Greatest value of a stored openness.
pub const LEVELS: u8 = 31;

/// Returns the open share, 0 to 1, in the direction of a surface at a distance relative to the reach.
#[inline]
pub fn open(distance: f32) -> f32 {
    if distance >= 1.0 { 1.0 } else { distance * distance }
}

/// Returns the irradiance of a place of this openness, relative to an open place. Near surfaces reflect as if lit
/// like the place itself (the closed form of Jiménez et al., *Practical Realtime Strategies for Accurate Indirect
/// Occlusion*, 2016, for equal albedos): `V / (1 − ρ (1 − V))`.
#[inline]
pub fn received(openness: f32) -> f32 {
    let v = openness.clamp(LEAST, 1.0);
    v / (1.0 - NEAR_ALBEDO * (1.0 - v))
}

/// Returns the value stored in a file.
#[inline]
pub fn stored(openness: f32) -> u8 {
    (openness.clamp(0.0, 1.0) * LEVELS as f32).round() as u8
}

/// Returns the factor of a point's irradiance for a stored openness: `1 / received(V)`, 1 to 1.5.
#[inline]
pub fn gain(stored: u8) -> f32 {
    1.0 / received(stored.min(LEVELS) as f32 / LEVELS as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_open_place_changes_nothing_and_less_open_ones_get_less() {
        assert_eq!((received(1.0), gain(stored(1.0)), gain(LEVELS)), (1.0, 1.0, 1.0));
        for i in 0..100 {
            let v = i as f32 / 100.0;
            assert!(received(v) <= received(v + 0.01) && received(v) >= v);
            assert!((stored(v) as f32 / LEVELS as f32 - v).abs() <= 0.5 / LEVELS as f32 + 1e-6);
        }
    }
}
