//! How far one picture is from another.

use crate::float_picture::FloatPicture;
use anyhow::{Result, bail};

/// How far a picture is from its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Root of the mean squared difference over the root of the reference's mean square.
    pub relative_rms: f64,
    /// The picture's mean over the reference's, less one.
    pub bias: f64,
}

/// Compares RGB of all pixels; alpha is left out.
///
/// # Errors
/// If the sizes differ, a value is not finite, or the reference is black: nothing could be far from it.
pub fn difference(picture: &FloatPicture, reference: &FloatPicture) -> Result<Difference> {
    if picture.size != reference.size {
        bail!("the pictures are of {:?} and {:?} pixels", picture.size, reference.size);
    }
    let (mut squares, mut reference_squares, mut sum, mut reference_sum) = (0.0, 0.0, 0.0, 0.0);
    for (a, b) in picture.rgba.iter().zip(&reference.rgba) {
        for (&a, &b) in a[..3].iter().zip(&b[..3]) {
            let (a, b) = (f64::from(a), f64::from(b));
            squares += (a - b) * (a - b);
            reference_squares += b * b;
            sum += a;
            reference_sum += b;
        }
    }
    if !(squares + reference_squares + sum + reference_sum).is_finite() {
        bail!("a value is not finite");
    }
    if reference_squares <= 0.0 || reference_sum <= 0.0 {
        bail!("the reference is black");
    }
    Ok(Difference { relative_rms: (squares / reference_squares).sqrt(), bias: sum / reference_sum - 1.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn flat(size: [usize; 2], value: f32) -> FloatPicture {
        FloatPicture { size, rgba: vec![[value, value, value, 1.0]; size[0] * size[1]] }
    }

    #[test]
    fn a_picture_scaled_by_a_factor_differs_by_that_factor() {
        let mut reference = flat([3, 2], 0.0);
        for (i, pixel) in reference.rgba.iter_mut().enumerate() {
            *pixel = [i as f32, 2.0 * i as f32, 1.0, 0.0];
        }
        let mut picture = reference.clone();
        picture.rgba.iter_mut().flatten().for_each(|value| *value *= 1.25);
        let found = difference(&picture, &reference).unwrap();
        assert!((found.relative_rms - 0.25).abs() < 1e-12 && (found.bias - 0.25).abs() < 1e-12, "{found:?}");
        assert_eq!(difference(&reference, &reference).unwrap().relative_rms, 0.0);
    }

    #[test]
    fn what_cannot_be_compared_is_refused() {
        assert!(difference(&flat([2, 2], 1.0), &flat([2, 3], 1.0)).is_err());
        assert!(difference(&flat([2, 2], 1.0), &flat([2, 2], 0.0)).is_err());
        assert!(difference(&flat([2, 2], f32::NAN), &flat([2, 2], 1.0)).is_err());
    }
}
