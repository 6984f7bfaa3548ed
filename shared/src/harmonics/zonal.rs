//! Convolution with lobes that are round about an axis.
//!
//! A lobe f(ω · a) has one number a band, Λ_l = 2π ∫ f(t) P_l(t) dt with the Legendre polynomial P_l. The mean of a function
//! under the lobe about a direction a is the function with its coefficients of band l multiplied by Λ_l, at a (Funk and
//! Hecke; Ramamoorthi and Hanrahan, *An Efficient Representation for Irradiance Environment Maps*, 2001, Eq. 5).

use super::{BANDS, COUNT, Coefficients, band};
use std::f32::consts::{FRAC_PI_4, PI};

/// Factor of each band.
pub type Lobe = [f32; BANDS];

/// The cosine lobe max(0, t): from radiance to irradiance.
pub const COSINE: Lobe = [PI, 2.0 * PI / 3.0, FRAC_PI_4, 0.0, -PI / 24.0];

/// Steps of the numeric integral.
const STEPS: u32 = 2048;

/// Returns the factors of a lobe, by quadrature; `lobe` is its value at the cosine of the angle to the axis.
pub fn factors(lobe: impl Fn(f64) -> f64) -> Lobe {
    let mut sums = [0.0f64; BANDS];
    for step in 0..STEPS {
        let t = 2.0 * (f64::from(step) + 0.5) / f64::from(STEPS) - 1.0;
        let value = lobe(t);
        sums.iter_mut().zip(legendre(t)).for_each(|(sum, p)| *sum += value * p);
    }
    sums.map(|sum| (sum * std::f64::consts::TAU * 2.0 / f64::from(STEPS)) as f32)
}

/// Returns the factors of a lobe of total 1 whose directions have a mean vector of this length, for the heat kernel on the
/// sphere: that to the power of l (l + 1) / 2.
pub fn of_mean_length(length: f32) -> Lobe {
    let (square, cube) = (length * length, length * length * length);
    [1.0, length, cube, cube * cube, cube * cube * square * square]
}

/// Returns the Legendre polynomials of the bands.
fn legendre(t: f64) -> [f64; BANDS] {
    let mut out = [1.0, t, 0.0, 0.0, 0.0];
    for l in 2..BANDS {
        let n = l as f64;
        out[l] = ((2.0 * n - 1.0) * t * out[l - 1] - (n - 1.0) * out[l - 2]) / n;
    }
    out
}

/// Returns the coefficients of a function convolved with a lobe.
pub fn convolved(coefficients: &Coefficients, lobe: &Lobe) -> Coefficients {
    let mut out = *coefficients;
    for (i, c) in (0..COUNT).zip(&mut out) {
        *c *= lobe[band(i)];
    }
    out
}
