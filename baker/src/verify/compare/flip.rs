//! LDR-FLIP: visibility of the difference between two alternating pictures (Andersson et al., *FLIP: A Difference
//! Evaluator for Alternating Images*, 2020).
//!
//! Colours are blurred by the contrast sensitivity of the eye at [`PIXELS_PER_DEGREE`] and compared in a uniform
//! colour space; edges and points present in only one picture raise a difference. 0 is no difference, 1 the
//! maximum.

use crate::io::picture::Picture;
use glam::{Mat3, Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::{FRAC_1_SQRT_2, PI};

/// Pixels per degree of the view: 3840 pixels over 0.7 m, seen from 0.7 m.
const PIXELS_PER_DEGREE: f32 = 0.7 * (3840.0 / 0.7) * (PI / 180.0);
/// Exponents of the colour and of the feature difference.
const COLOUR_EXPONENT: f32 = 0.7;
const FEATURE_EXPONENT: f32 = 0.5;
/// Colour differences below the first share of the maximum map to the second share of the range.
const KNEE: [f32; 2] = [0.4, 0.95];
/// Width of a feature (edge or point), degrees.
const FEATURE_WIDTH: f32 = 0.082;
/// Columns: linear sRGB to XYZ.
const XYZ_FROM_RGB: Mat3 = Mat3::from_cols(
    Vec3::new(0.412_390_8, 0.212_639, 0.019_330_82),
    Vec3::new(0.357_584_33, 0.715_168_66, 0.119_194_78),
    Vec3::new(0.180_480_8, 0.072_192_32, 0.950_532_16),
);
/// Contrast sensitivity of luminance, red to green and blue to yellow: two Gaussians each, weight and width (table 1).
const SENSITIVITY: [[Vec2; 2]; 3] = [
    [Vec2::new(1.0, 0.0047), Vec2::new(0.0, 1e-5)],
    [Vec2::new(1.0, 0.0053), Vec2::new(0.0, 1e-5)],
    [Vec2::new(34.1, 0.04), Vec2::new(13.5, 0.025)],
];

/// Mean LDR-FLIP of two pictures of equal size, linear RGB from 0 to 1; 0 for empty pictures.
pub fn flip(picture: &Picture, reference: &Picture) -> f64 {
    let differences = map(picture, reference);
    differences.iter().map(|d| *d as f64).sum::<f64>() / differences.len().max(1) as f64
}

/// LDR-FLIP pixel by pixel.
fn map(picture: &Picture, reference: &Picture) -> Vec<f32> {
    let size = [picture.width as usize, picture.height as usize];
    let pictures = [picture, reference];
    let opponent = pictures.map(|picture| picture.pixels.iter().map(|p| ycxcz(*p)).collect::<Vec<_>>());
    let colours = opponent.each_ref().map(|pixels| seen(pixels, size));
    let features = opponent.each_ref().map(|pixels| features(pixels, size));
    let greatest = hyab(hunt(Vec3::Y), hunt(Vec3::Z)).powf(COLOUR_EXPONENT);
    let knee = KNEE[0] * greatest;
    let pixel = |i: usize| {
        let far = hyab(colours[0][i], colours[1][i]).powf(COLOUR_EXPONENT);
        let colour = if far < knee {
            far * KNEE[1] / knee
        } else {
            KNEE[1] + (far - knee) / (greatest - knee) * (1.0 - KNEE[1])
        };
        let feature = (features[0][i] - features[1][i]).abs().max_element();
        colour.powf(1.0 - (FRAC_1_SQRT_2 * feature).powf(FEATURE_EXPONENT))
    };
    (0..picture.pixels.len()).into_par_iter().map(pixel).collect()
}

/// Reference white.
fn white() -> Vec3 {
    XYZ_FROM_RGB * Vec3::ONE
}

/// Converts linear RGB to the opponent space YCxCz, the space of the eye's blur.
fn ycxcz(rgb: Vec3) -> Vec3 {
    let xyz = XYZ_FROM_RGB * rgb / white();
    Vec3::new(116.0 * xyz.y - 16.0, 500.0 * (xyz.x - xyz.y), 200.0 * (xyz.y - xyz.z))
}

fn rgb_of_ycxcz(c: Vec3) -> Vec3 {
    let y = (c.x + 16.0) / 116.0;
    XYZ_FROM_RGB.inverse() * (Vec3::new(y + c.y / 500.0, y, y - c.z / 200.0) * white())
}

/// Converts linear RGB to L*a*b* with chroma scaled by lightness (Hunt effect).
fn hunt(rgb: Vec3) -> Vec3 {
    const EDGE: f32 = 6.0 / 29.0;
    let curve = |t: f32| {
        if t > EDGE * EDGE * EDGE { t.cbrt() } else { t / (3.0 * EDGE * EDGE) + 4.0 / 29.0 }
    };
    let f = (XYZ_FROM_RGB * rgb / white()).map(curve);
    let lightness = 116.0 * f.y - 16.0;
    let chroma = 0.01 * lightness * Vec2::new(500.0 * (f.x - f.y), 200.0 * (f.y - f.z));
    Vec3::new(lightness, chroma.x, chroma.y)
}

/// The HyAB distance: city block in lightness, Euclidean in chroma.
fn hyab(a: Vec3, b: Vec3) -> f32 {
    let d = a - b;
    d.x.abs() + d.y.hypot(d.z)
}

/// A filter along one axis: its values from −r to r.
type Kernel = Vec<f32>;

/// Colours after the blur of the eye, for [`hyab`].
fn seen(pixels: &[Vec3], size: [usize; 2]) -> Vec<Vec3> {
    let widest = SENSITIVITY.iter().flatten().fold(0f32, |most, gaussian| most.max(gaussian.y));
    let radius = (3.0 * (widest / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as i32;
    let mut blurred = vec![Vec3::ZERO; pixels.len()];
    for (channel, gaussians) in SENSITIVITY.iter().enumerate() {
        let values: Vec<f32> = pixels.iter().map(|p| p[channel]).collect();
        let mut total = 0.0;
        let mut sum = vec![0.0; pixels.len()];
        for gaussian in gaussians.iter().filter(|gaussian| gaussian.x > 0.0) {
            let value = |i: i32| (-(PI * i as f32 / PIXELS_PER_DEGREE).powi(2) / gaussian.y).exp();
            let kernel: Kernel = (-radius..=radius).map(value).collect();
            let weight = gaussian.x * (PI / gaussian.y).sqrt();
            total += weight * kernel.iter().sum::<f32>().powi(2);
            let part = filtered(&values, size, &kernel, &kernel);
            sum.iter_mut().zip(part).for_each(|(sum, part)| *sum += weight * part);
        }
        blurred.iter_mut().zip(sum).for_each(|(pixel, sum)| pixel[channel] = sum / total);
    }
    blurred.into_iter().map(|p| hunt(rgb_of_ycxcz(p).clamp(Vec3::ZERO, Vec3::ONE))).collect()
}

/// Edge strength and point strength at each pixel.
fn features(pixels: &[Vec3], size: [usize; 2]) -> Vec<Vec2> {
    let values: Vec<f32> = pixels.iter().map(|p| (p.x + 16.0) / 116.0).collect();
    let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
    let radius = (3.0 * deviation).ceil() as i32;
    let places = || (-radius..=radius).map(|i| i as f32 / deviation);
    let gauss = |t: f32| (-0.5 * t * t).exp();
    let total: f32 = places().map(gauss).sum();
    let smooth: Kernel = places().map(|t| gauss(t) / total).collect();
    // Scales the positive and the negative values to sum 1 and −1.
    let balanced = |kernel: Kernel| -> Kernel {
        let sum = |sign: f32| kernel.iter().map(|v| (sign * v).max(0.0)).sum::<f32>();
        let (above, below) = (sum(1.0), sum(-1.0));
        kernel.into_iter().map(|v| v / if v < 0.0 { below } else { above }).collect()
    };
    let edge = balanced(places().map(|t| -t * gauss(t)).collect());
    let point = balanced(places().map(|t| (t * t - 1.0) * gauss(t)).collect());
    let length = |kernel: &Kernel| -> Vec<f32> {
        let across = filtered(&values, size, kernel, &smooth);
        let along = filtered(&values, size, &smooth, kernel);
        across.iter().zip(along).map(|(x, y)| x.hypot(y)).collect()
    };
    length(&edge).into_iter().zip(length(&point)).map(|(edge, point)| Vec2::new(edge, point)).collect()
}

/// Convolves along rows, then along columns; pixels beyond the border repeat the border pixel.
fn filtered(values: &[f32], [width, height]: [usize; 2], rows: &Kernel, columns: &Kernel) -> Vec<f32> {
    let along = |kernel: &Kernel, length: usize, i: usize, value: &dyn Fn(usize) -> f32| -> f32 {
        let radius = (kernel.len() / 2) as isize;
        let at = |k: usize| (i as isize + k as isize - radius).clamp(0, length as isize - 1) as usize;
        kernel.iter().enumerate().map(|(k, weight)| weight * value(at(k))).sum()
    };
    let pixels = || (0..values.len()).into_par_iter();
    let across = |i: usize| along(rows, width, i % width, &|x| values[i / width * width + x]);
    let between: Vec<f32> = pixels().map(across).collect();
    pixels().map(|i| along(columns, height, i / width, &|y| between[y * width + i % width])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of sRGB values.
    fn picture(value: impl Fn(f32, f32) -> [f32; 3]) -> Picture {
        let linear = |s: f32| if s <= 0.04045 { s / 12.92 } else { ((s + 0.055) / 1.055).powf(2.4) };
        let pixel = |i: u32| Vec3::from(value((i % 48) as f32, (i / 48) as f32)).map(linear);
        Picture { width: 48, height: 32, pixels: (0..48 * 32).map(pixel).collect() }
    }

    /// The values are those of the authors' program (flip-evaluator 1.7).
    #[test]
    fn pictures_differ_by_what_the_published_program_finds() {
        let stripes = |x: f32, y: f32, step: f32| ((x * 7.0 + y * step) % 16.0) / 16.0;
        let a = picture(|x, y| [x / 48.0, y / 32.0, stripes(x, y, 3.0)]);
        let b = picture(|x, y| {
            let check = ((x / 8.0).floor() + (y / 8.0).floor()) % 2.0;
            [(x / 48.0 + 0.1 * check).min(1.0), (y / 32.0).powi(2), stripes(x, y, 5.0)]
        });
        let found = map(&b, &a);
        let greatest = found.iter().fold(0f32, |most, v| most.max(*v));
        for (found, published) in
            [(greatest, 0.8359), (found[5 * 48 + 7], 0.24955), (found[20 * 48 + 40], 0.71266)]
        {
            assert!((found - published).abs() < 1e-3, "{found}, published {published}");
        }
        assert!((flip(&b, &a) - 0.532_637).abs() < 5e-4, "{}", flip(&b, &a));
        assert_eq!(flip(&a, &a), 0.0);
    }

    #[test]
    fn a_dot_is_a_small_difference_and_white_for_black_the_greatest() {
        let black = picture(|_, _| [0.0; 3]);
        let dot = picture(|x, y| [if (x, y) == (24.0, 16.0) { 1.0 } else { 0.0 }; 3]);
        let white = picture(|_, _| [1.0; 3]);
        for (other, published) in [(dot, 0.009_316), (white, 0.967_399)] {
            let found = flip(&other, &black);
            assert!((found - published).abs() < 5e-4, "{found}, published {published}");
        }
    }
}
