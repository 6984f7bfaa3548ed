//! Error measures between a picture and a reference.

use super::flip::flip;
use super::uncertainty::{ErrorEstimate, Pixel, estimate};
use crate::io::picture::Picture;
use glam::Vec3;

/// Side of the blocks of [`Comparison::p95`], pixels; noise may be correlated within a block.
const BLOCK: u32 = 8;

/// Difference of a picture from its reference. Light where the reference is black counts, too.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Comparison {
    /// Root mean square of the difference over the reference's root mean square, with confidence
    /// interval.
    #[serde(flatten)]
    pub error: ErrorEstimate,
    /// The picture's mean over the reference's, less one; 0 is perfect.
    pub bias: f64,
    /// 95th percentile, over blocks of 8 by 8 pixels, of the difference of the blocks' means over the
    /// reference's mean: leaks and blotches.
    pub p95: f64,
}

/// Reason for a failed comparison.
#[derive(Debug, thiserror::Error)]
pub enum CompareError {
    /// The sizes of picture and reference differ.
    #[error("the picture is {0}x{1}, the reference {2}x{3}: take both at the same --size")]
    Size(u32, u32, u32, u32),
    /// A pixel of a picture or a reference is not finite.
    #[error("{0} pixels of the pictures are not finite")]
    NotFinite(usize),
    /// Identical noise in both references does not cancel.
    #[error("both references are the same picture: take the second one with another --seed, or leave it out")]
    SameReferences,
    /// The picture equals a reference: noise must be independent.
    #[error("the picture is one of the two references: compare it with the other one alone")]
    OwnReference,
    /// Hardly a pixel is lit in both references.
    #[error("the references are too noisy to tell anything: take both with more samples a pixel (--spp)")]
    TooNoisy,
    /// The reference is black: relative errors are undefined.
    #[error("the reference is black: take it of a place with light")]
    Black,
}

/// Compares two RGB pictures. With a second reference of independent noise, the noise of the
/// references cancels out of the error, `E[(p − a)(p − b)] = (p − truth)²`, and gives the
/// confidence interval ([`super::uncertainty`]). With a single reference, the noise is part of the
/// error.
///
/// # Errors
/// [`CompareError`].
pub fn compare(
    picture: &Picture,
    reference: &Picture,
    second: Option<&Picture>,
) -> Result<Comparison, CompareError> {
    if second == Some(reference) {
        return Err(CompareError::SameReferences);
    }
    if second.is_some_and(|second| picture == reference || picture == second) {
        return Err(CompareError::OwnReference);
    }
    let is_noise_known = second.is_some();
    let second = second.unwrap_or(reference);
    for other in [reference, second] {
        if (picture.width, picture.height) != (other.width, other.height) {
            return Err(CompareError::Size(picture.width, picture.height, other.width, other.height));
        }
    }
    let all = picture.pixels.iter().chain(&reference.pixels).chain(&second.pixels);
    let bad = all.filter(|p| !p.is_finite()).count();
    if bad > 0 {
        return Err(CompareError::NotFinite(bad));
    }
    let (mut squares, mut power, mut sum, mut reference_sum, mut seen) = (0.0, 0.0, 0.0, 0.0, 0u64);
    for ((p, a), b) in picture.pixels.iter().zip(&reference.pixels).zip(&second.pixels) {
        let (p, a, b) = (p.as_dvec3(), a.as_dvec3(), b.as_dvec3());
        squares += (p - a).dot(p - b);
        power += a.dot(b);
        sum += p.element_sum();
        reference_sum += 0.5 * (a + b).element_sum();
        seen += ((a + b).element_sum() > 0.0) as u64;
    }
    if reference_sum <= 0.0 {
        return Err(CompareError::Black);
    }
    if power <= 0.0 {
        return Err(CompareError::TooNoisy);
    }
    let error = match is_noise_known {
        true => estimate(pixels_of_blocks(picture, reference, second), power),
        false => ErrorEstimate::with_noise((squares / power).sqrt()),
    };
    let mean = reference_sum / (3 * seen) as f64;
    let mut local = blocks(picture, reference, second);
    local.iter_mut().for_each(|difference| *difference /= mean);
    Ok(Comparison { error, bias: sum / reference_sum - 1.0, p95: percentile(local, 0.95) })
}

/// Visible difference from a reference of equal size: mean [LDR-FLIP](flip) of the two pictures,
/// tone-mapped with the reference's mean at a quarter, and averaged over blocks of 2 by 2 pixels,
/// enough to suppress most of the noise; 0 to 1.
pub fn noticed(picture: &Picture, reference: &Picture) -> f64 {
    let light = |p: &&Vec3| p.element_sum() > 0.0;
    let seen = reference.pixels.iter().filter(light).count().max(1) as f64;
    let mean = reference.pixels.iter().map(|p| p.as_dvec3().element_sum()).sum::<f64>() / (3.0 * seen);
    let exposure = (0.25 / mean.max(1e-30)) as f32;
    flip(&display(picture, exposure), &display(reference, exposure))
}

/// Displayable picture at half size: radiance times `exposure`, tone-mapped by x / (1 + mean of the
/// channels). Linear RGB from 0 to 1.
fn display(picture: &Picture, exposure: f32) -> Picture {
    let (width, height) = (picture.width / 2, picture.height / 2);
    let pixel = |i: u32| {
        let first = (i / width * 2 * picture.width + i % width * 2) as usize;
        let below = first + picture.width as usize;
        let block = [first, first + 1, below, below + 1];
        let sum: Vec3 = block.iter().map(|at| picture.pixels[*at]).sum();
        let lit = (sum * (0.25 * exposure)).max(Vec3::ZERO);
        (lit / (1.0 + lit.element_sum() / 3.0)).min(Vec3::ONE)
    };
    Picture { width, height, pixels: (0..width * height).map(pixel).collect() }
}

/// Per full block: mean over the channels of |picture − mean of the references|, of the block's
/// means.
fn blocks(picture: &Picture, a: &Picture, b: &Picture) -> Vec<f64> {
    let (columns, rows) = (picture.width / BLOCK, picture.height / BLOCK);
    let block = |i: u32| {
        let (x0, y0) = (i % columns * BLOCK, i / columns * BLOCK);
        let mut sum = glam::DVec3::ZERO;
        for y in y0..y0 + BLOCK {
            for x in x0..x0 + BLOCK {
                let at = (y * picture.width + x) as usize;
                let reference = 0.5 * (a.pixels[at].as_dvec3() + b.pixels[at].as_dvec3());
                sum += picture.pixels[at].as_dvec3() - reference;
            }
        }
        sum.abs().element_sum() / (3 * BLOCK * BLOCK) as f64
    };
    (0..columns * rows).map(block).collect()
}

/// Pixels by block, including partial blocks at the right and bottom edges.
fn pixels_of_blocks<'a>(
    picture: &'a Picture,
    a: &'a Picture,
    b: &'a Picture,
) -> impl Iterator<Item = Vec<Pixel>> + Clone + 'a {
    let (columns, rows) = (picture.width.div_ceil(BLOCK), picture.height.div_ceil(BLOCK));
    (0..rows).flat_map(move |row| (0..columns).map(move |column| [column, row])).map(move |[column, row]| {
        let mut pixels = Vec::with_capacity((BLOCK * BLOCK) as usize);
        for y in row * BLOCK..((row + 1) * BLOCK).min(picture.height) {
            for x in column * BLOCK..((column + 1) * BLOCK).min(picture.width) {
                let at = (y * picture.width + x) as usize;
                pixels.push([picture, a, b].map(|picture| picture.pixels[at].as_dvec3()));
            }
        }
        pixels
    })
}

/// Interpolated quantile `share` (0 to 1) of the values; 0 for an empty list.
pub(super) fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let at = share * values.len().saturating_sub(1) as f64;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    let Some((below, above)) = values.get(low).zip(values.get(high)) else { return 0.0 };
    below + (above - below) * at.fract()
}

/// Signed difference as a displayable picture: grey where the pictures agree, red where the picture
/// is too bright, blue where it is too dark; `gain` times the difference over the reference's root
/// mean square. Linear RGB from 0 to 1.
pub fn signed_difference(picture: &Picture, reference: &Picture, gain: f32) -> Picture {
    let power: f64 = reference.pixels.iter().map(|p| p.as_dvec3().length_squared()).sum();
    let rms = (power / (3 * reference.pixels.len()).max(1) as f64).sqrt() as f32;
    let scale = gain / (3.0 * rms.max(f32::MIN_POSITIVE));
    let colour = |(p, r): (&Vec3, &Vec3)| {
        let d = ((p - r).element_sum() * scale).clamp(-1.0, 1.0);
        let grey = 0.4 * (1.0 - d.abs());
        Vec3::new(grey + d.max(0.0), grey, grey + (-d).max(0.0))
    };
    let pixels = picture.pixels.iter().zip(&reference.pixels).map(colour).collect();
    Picture { pixels, ..*picture }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    fn made(of: impl Fn(u32) -> Vec3) -> Picture {
        Picture { width: 32, height: 24, pixels: (0..32 * 24).map(of).collect() }
    }

    #[test]
    fn a_picture_scaled_by_a_factor_differs_by_that_factor() {
        let reference = made(|i| Vec3::new(i as f32, 2.0 * i as f32, 1.0));
        let picture = made(|i| 1.25 * Vec3::new(i as f32, 2.0 * i as f32, 1.0));
        let found = compare(&picture, &reference, None).unwrap();
        assert!((found.error.figure() - 0.25).abs() < 1e-6 && (found.bias - 0.25).abs() < 1e-6, "{found:?}");
        let same = compare(&reference, &reference, None).unwrap();
        assert_eq!(same, Comparison { error: ErrorEstimate::with_noise(0.0), bias: 0.0, p95: 0.0 });
    }

    #[test]
    fn noise_of_two_references_cancels() {
        let noisy = |seed| made(|i| Vec3::splat(1.0 + 0.5 * (Stream::new(seed, i as u64).unit() - 0.5)));
        let (a, b) = (noisy(1), noisy(2));
        let picture = made(|_| Vec3::splat(1.1));
        let found = compare(&picture, &a, Some(&b)).unwrap();
        assert!((found.error.figure() - 0.1).abs() < 0.01, "{found:?}");
        assert!(compare(&picture, &a, None).unwrap().error.figure() > 0.15);
    }

    #[test]
    fn a_blotch_shows_in_the_blocks() {
        let reference = made(|_| Vec3::ONE);
        // One of the twelve blocks is off, the other eleven are equal.
        let blotch = made(|i| if i % 32 < 8 && i / 32 < 8 { Vec3::splat(3.0) } else { Vec3::ONE });
        let found = compare(&blotch, &reference, None).unwrap();
        // Eleven zeros and a two: the 95th percentile is at 0.45 between the last zero and the two.
        assert!((found.p95 - 0.9).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn what_cannot_be_compared_is_refused() {
        let one = made(|_| Vec3::ONE);
        let small = Picture { width: 8, height: 8, pixels: vec![Vec3::ONE; 64] };
        assert!(matches!(compare(&one, &small, None), Err(CompareError::Size(..))));
        assert!(matches!(compare(&one, &made(|_| Vec3::ZERO), None), Err(CompareError::Black)));
        assert!(matches!(compare(&one, &one, Some(&made(|_| Vec3::X))), Err(CompareError::OwnReference)));
        let lit = |odd| made(move |i| Vec3::splat((i % 2 == odd) as u32 as f32));
        assert!(matches!(compare(&one, &lit(0), Some(&lit(1))), Err(CompareError::TooNoisy)));
        let nan = made(|i| if i == 3 { Vec3::NAN } else { Vec3::ONE });
        assert!(matches!(compare(&nan, &one, None), Err(CompareError::NotFinite(1))));
        assert!(matches!(compare(&made(|_| Vec3::X), &one, Some(&nan)), Err(CompareError::NotFinite(1))));
    }

    #[test]
    fn light_where_there_should_be_none_counts() {
        let reference = made(|i| Vec3::splat((i % 2) as f32));
        let picture = made(|_| Vec3::ONE);
        let found = compare(&picture, &reference, None).unwrap();
        assert!((found.error.figure() - 1.0).abs() < 1e-9 && (found.bias - 1.0).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn too_bright_is_red_and_too_dark_is_blue() {
        let reference = made(|_| Vec3::ONE);
        let picture = made(|i| Vec3::splat([1.0, 1.2, 0.8][(i % 3) as usize]));
        let shown = signed_difference(&picture, &reference, 4.0).pixels;
        assert!(shown[0].x == shown[0].z && shown[1].x > shown[1].z && shown[2].z > shown[2].x);
    }
}
