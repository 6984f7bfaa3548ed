//! Real spherical harmonics of the first five bands: 25 functions on the sphere.
//!
//! * here: [`evaluate`], the functions at a direction;
//! * [`rotation`] – coefficients of a turned function (Ivanic and Ruedenberg 1996);
//! * [`zonal`] – lobes that are round about an axis: convolution by one factor a band.
//!
//! Function i = l (l + 1) + m has the band l and the order m, −l ≤ m ≤ l. The polar axis is z; signs are those of Sloan,
//! *Stupid Spherical Harmonics Tricks*, 2008, appendix A2, without the Condon–Shortley phase: bands 0 and 1 are
//! √(1/4π) and √(3/4π) (y, z, x). The functions are orthonormal: ∫ y_i y_j dω = δ_ij.

pub mod rotation;
pub mod zonal;

use glam::Vec3;

/// Number of bands.
pub const BANDS: usize = 5;
/// Number of functions.
pub const COUNT: usize = BANDS * BANDS;

/// Coefficients of a function of direction, linear RGB.
pub type Coefficients = [Vec3; COUNT];

/// Band of a function.
#[inline]
pub const fn band(i: usize) -> usize {
    (i >= 1) as usize + (i >= 4) as usize + (i >= 9) as usize + (i >= 16) as usize
}

/// Returns the functions at a unit direction.
#[inline]
pub fn evaluate(direction: Vec3) -> [f32; COUNT] {
    let Vec3 { x, y, z } = direction;
    let (xx, yy, zz) = (x * x, y * y, z * z);
    [
        0.282_094_8,
        0.488_602_5 * y,
        0.488_602_5 * z,
        0.488_602_5 * x,
        1.092_548_4 * x * y,
        1.092_548_4 * y * z,
        0.315_391_57 * (3.0 * zz - 1.0),
        1.092_548_4 * x * z,
        0.546_274_2 * (xx - yy),
        0.590_043_6 * y * (3.0 * xx - yy),
        2.890_611_4 * x * y * z,
        0.457_045_8 * y * (5.0 * zz - 1.0),
        0.373_176_34 * z * (5.0 * zz - 3.0),
        0.457_045_8 * x * (5.0 * zz - 1.0),
        1.445_305_7 * z * (xx - yy),
        0.590_043_6 * x * (xx - 3.0 * yy),
        2.503_343 * x * y * (xx - yy),
        1.770_130_8 * y * z * (3.0 * xx - yy),
        0.946_174_7 * x * y * (7.0 * zz - 1.0),
        0.669_046_5 * y * z * (7.0 * zz - 3.0),
        0.105_785_55 * (35.0 * zz * zz - 30.0 * zz + 3.0),
        0.669_046_5 * x * z * (7.0 * zz - 3.0),
        0.473_087_35 * (xx - yy) * (7.0 * zz - 1.0),
        1.770_130_8 * x * z * (xx - 3.0 * yy),
        0.625_835_7 * (xx * (xx - 3.0 * yy) - yy * (3.0 * xx - yy)),
    ]
}

/// Returns the value of a function with these coefficients.
#[inline]
pub fn value(coefficients: &Coefficients, direction: Vec3) -> Vec3 {
    evaluate(direction).iter().zip(coefficients).map(|(y, c)| *c * *y).sum()
}

#[cfg(test)]
mod tests;
