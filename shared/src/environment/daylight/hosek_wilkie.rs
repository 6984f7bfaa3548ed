//! Radiance of the clear sky: Hosek and Wilkie, *An Analytic Model for Full Spectral Sky-Dome Radiance*, ACM
//! Transactions on Graphics 31(4), 2012; the RGB version of their data, `data/hosek_wilkie_rgb.bin`, under the licence
//! beside it.
//!
//! The data are 32-bit floats, little-endian: for red, green and blue the nine coefficients of the distribution, then for
//! each the mean radiance. A quantity has two albedos of the ground (0, 1), each ten turbidities, each six control points
//! of a Bézier curve over the sun's elevation.

use super::UNIT;
use crate::elementary::{Elementary, ElementaryVector};
use glam::Vec3;
use std::f32::consts::FRAC_PI_2;

static DATA: &[u8] = include_bytes!("data/hosek_wilkie_rgb.bin");
/// Coefficients of the distribution.
const COEFFICIENTS: usize = 9;
/// Turbidities of the data, 1 to 10.
const TURBIDITIES: usize = 10;
/// Control points of a Bézier curve.
const CONTROLS: usize = 6;
/// Numbers of one quantity of one channel.
const QUANTITY: usize = 2 * TURBIDITIES * CONTROLS;
/// Luminous efficacy at the peak, lm/W: the data are per channel what Y is of CIE XYZ.
const LUMENS: f32 = 683.0;

/// The model for one position of the sun.
#[derive(Clone, Debug)]
pub struct SkyModel {
    /// A to I of the paper's Eq. 8, RGB.
    coefficients: [Vec3; COEFFICIENTS],
    /// Scale of the distribution, W/(sr m²) in [`UNIT`]s.
    radiance: Vec3,
}

impl SkyModel {
    /// The sky with the sun at an elevation in degrees (0 to 90; below the horizon as at 0), a turbidity of 1 to 10, and
    /// an albedo of the ground of 0 to 1.
    pub fn new(elevation_deg: f32, turbidity: f32, albedo: Vec3) -> Self {
        let elevation = elevation_deg.to_radians().clamp(0.0, FRAC_PI_2);
        let weights = bernstein((elevation / FRAC_PI_2).cube_root());
        let vector = |value: &dyn Fn(usize, f32) -> f32| {
            Vec3::from_array(std::array::from_fn(|channel| value(channel, albedo[channel])))
        };
        let coefficients = std::array::from_fn(|i| {
            vector(&|channel, albedo| {
                let first = channel * COEFFICIENTS * QUANTITY + i;
                interpolated(first, COEFFICIENTS, turbidity, albedo, &weights)
            })
        });
        let radiance = vector(&|channel, albedo| {
            let first = 3 * COEFFICIENTS * QUANTITY + channel * QUANTITY;
            interpolated(first, 1, turbidity, albedo, &weights)
        });
        Self { coefficients, radiance: radiance * (LUMENS / UNIT) }
    }

    /// Radiance from a unit direction above the horizon, W/(sr m²); `sun` is the unit direction towards the sun. The
    /// sun's disk is not in it.
    pub fn radiance(&self, view: Vec3, sun: Vec3) -> Vec3 {
        let [a, b, c, d, e, f, g, i, h] = self.coefficients;
        let cosine = view.dot(sun).clamp(-1.0, 1.0);
        let (angle, up) = (cosine.arc_cosine(), view.y.max(0.0));
        let mie = (1.0 + h * h - 2.0 * h * cosine).max(Vec3::splat(1e-6)).power(1.5).recip()
            * (1.0 + cosine * cosine);
        let horizon = 1.0 + a * (b / (up + 0.01)).exponential();
        let glow = c + d * (e * angle).exponential() + f * (cosine * cosine) + g * mie + i * up.sqrt();
        (self.radiance * horizon * glow).max(Vec3::ZERO)
    }
}

/// Weights of the control points of a Bézier curve of degree five.
fn bernstein(t: f32) -> [f32; CONTROLS] {
    let binomial = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    std::array::from_fn(|k| binomial[k] * (1.0 - t).powi(5 - k as i32) * t.powi(k as i32))
}

/// A number of the data at a turbidity, an albedo and the weights of control points. `first` is its first place, `stride`
/// the distance of control points.
fn interpolated(first: usize, stride: usize, turbidity: f32, albedo: f32, weights: &[f32; CONTROLS]) -> f32 {
    let turbidity = (turbidity - 1.0).clamp(0.0, (TURBIDITIES - 1) as f32);
    let low = turbidity as usize;
    let high = (low + 1).min(TURBIDITIES - 1);
    let curve = |albedo: usize, turbidity: usize| -> f32 {
        let start = first + (albedo * TURBIDITIES + turbidity) * CONTROLS * stride;
        weights.iter().enumerate().map(|(k, weight)| weight * number(start + k * stride)).sum()
    };
    let at = |albedo: usize| {
        let share = turbidity - low as f32;
        curve(albedo, low) * (1.0 - share) + curve(albedo, high) * share
    };
    at(0) * (1.0 - albedo) + at(1) * albedo
}

/// A number of the data.
fn number(index: usize) -> f32 {
    let (numbers, _) = DATA.as_chunks::<4>();
    f32::from_le_bytes(numbers[index])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_data_have_their_size_and_the_authors_first_numbers() {
        assert_eq!(DATA.len(), 4 * 3 * (COEFFICIENTS + 1) * QUANTITY);
        // datasetRGB1 and datasetRGBRad1 of the authors' ArHosekSkyModelData_RGB.h.
        let places = [0, 1, 8, 3 * COEFFICIENTS * QUANTITY];
        for (place, authors) in places.into_iter().zip([-1.099_459, -0.133_514_6, 0.512_771_8, 1.962_684]) {
            assert!((number(place) - authors).abs() < 1e-6, "{place}: {}", number(place));
        }
    }

    #[test]
    fn numbers_of_the_data_are_met_at_whole_turbidities_and_ends_of_curves() {
        let ground = [Vec3::ZERO, Vec3::ONE];
        for (albedo, turbidity) in [(0, 1), (1, 1), (0, 7), (1, 10)] {
            let model = SkyModel::new(90.0, turbidity as f32, ground[albedo]);
            let place = ((albedo * TURBIDITIES + turbidity - 1) * CONTROLS + 5) * COEFFICIENTS;
            for (i, coefficient) in model.coefficients.iter().enumerate() {
                assert_eq!(coefficient.x, number(place + i));
                assert_eq!(coefficient.z, number(2 * COEFFICIENTS * QUANTITY + place + i));
            }
        }
    }

    #[test]
    fn the_model_gives_the_authors_values() {
        // Horizontal illuminance and zenith luminance, computed in 64 bits from the authors' data and formula (Eq. 8).
        let cases = [(60.0, 2.0, 3_088.0), (30.0, 3.0, 2_106.0), (90.0, 3.0, 11_683.0), (5.0, 6.0, 921.0)];
        for (elevation_deg, turbidity, zenith) in cases {
            let model = SkyModel::new(elevation_deg, turbidity, Vec3::splat(0.2));
            let (sin, cos) = elevation_deg.to_radians().sin_cos();
            // The middle of the first pixel of 256 by 128.
            let view = super::super::super::picture::direction_at(0.5 / 256.0, 0.5 / 128.0);
            let light = crate::colour::luminance(model.radiance(view, Vec3::new(cos, sin, 0.0))) * UNIT;
            assert!((light / zenith - 1.0).abs() < 2e-3, "{elevation_deg} {turbidity}: {light}");
        }
    }
}
