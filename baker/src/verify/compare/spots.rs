//! Spottiness of bare surfaces in a picture.
//!
//! Bounced light on a bare wall is smooth: any variation at the size of spots is error, independent of the true
//! light, and a root mean square error hides spots. The measure is the logarithm of the luminance between two
//! Gaussian blurs.

use super::error::percentile;
use crate::io::picture::Picture;
use rebounce_shared::colour::luminance;

/// Standard deviations of the two blurs, over the picture's height.
const BLUR: [f64; 2] = [0.006, 0.04];
/// Radius of a blur kernel, standard deviations.
const REACH: f64 = 3.0;

/// A rectangle of a picture: left, top, right, bottom, as shares of its width and height.
pub type Rectangle = [f64; 4];

/// Spots in a rectangle. A value of 15 (1% of the brightness) is the visibility threshold; real gradients give
/// about 5.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct Spots {
    /// Standard deviation, thousandths of a stop.
    pub deviation: f64,
    /// 99.5th percentile of the size, thousandths of a stop.
    pub greatest: f64,
}

/// Measures spots in a rectangle of linear radiance; returns zeros for a rectangle smaller than twice the wider
/// blur.
pub fn spots(picture: &Picture, [left, top, right, bottom]: Rectangle) -> Spots {
    let (width, height) = (f64::from(picture.width), f64::from(picture.height));
    let at = |share: f64, side: f64| (share * side).max(0.0).min(side) as usize;
    let (columns, rows) = (at(left, width)..at(right, width), at(top, height)..at(bottom, height));
    let mut part = Plane { width: columns.len(), values: Vec::new() };
    for y in rows {
        let row = &picture.pixels[y * picture.width as usize..][columns.clone()];
        part.values.extend(row.iter().map(|pixel| f64::from(luminance(*pixel)).max(1e-9).log2()));
    }
    let [fine, coarse] = BLUR.map(|deviation| part.blurred(deviation * height));
    let margin = (BLUR[1] * height) as usize;
    let inner = |k: &usize| {
        let (x, y) = (k % part.width, k / part.width);
        let of = |at: usize, side: usize| at >= margin && at + margin < side;
        of(x, part.width) && of(y, part.values.len() / part.width)
    };
    let difference = |k: usize| 1000.0 * (fine.values[k] - coarse.values[k]);
    let band: Vec<f64> = (0..part.values.len()).filter(inner).map(difference).collect();
    let count = band.len().max(1) as f64;
    let mean = band.iter().sum::<f64>() / count;
    let variance = band.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    let sizes = band.iter().map(|value| value.abs()).collect();
    Spots { deviation: variance.sqrt(), greatest: percentile(sizes, 0.995) }
}

/// Numbers, row after row.
struct Plane {
    width: usize,
    values: Vec<f64>,
}

impl Plane {
    /// Returns the plane blurred by a Gaussian of standard deviation `deviation`, pixels; edge values repeat beyond
    /// edges.
    fn blurred(&self, deviation: f64) -> Plane {
        let reach = (REACH * deviation + 1.0) as isize;
        let weight = |offset: isize| (-0.5 * (offset as f64 / deviation).powi(2)).exp();
        let weights: Vec<f64> = (-reach..=reach).map(weight).collect();
        let total: f64 = weights.iter().sum();
        let height = self.values.len() / self.width.max(1);
        let along = |values: &[f64], step: usize, count: usize, first: usize, at: usize| {
            let near = |offset: isize| (at as isize + offset).max(0).min(count as isize - 1) as usize;
            let of = |(weight, offset): (&f64, isize)| weight * values[first + step * near(offset)];
            weights.iter().zip(-reach..).map(of).sum::<f64>() / total
        };
        let pixel = |k: usize| (k % self.width, k / self.width);
        let count = self.values.len();
        let rows: Vec<f64> =
            (0..count).map(|k| along(&self.values, 1, self.width, k - pixel(k).0, pixel(k).0)).collect();
        let values = (0..count).map(|k| along(&rows, self.width, height, pixel(k).0, pixel(k).1)).collect();
        Plane { width: self.width, values }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const ALL: Rectangle = [0.0, 0.0, 1.0, 1.0];

    fn made(of: impl Fn(f32, f32) -> f32) -> Picture {
        let pixel = |k: u32| Vec3::splat(of((k % 200) as f32, (k / 200) as f32));
        Picture { width: 200, height: 150, pixels: (0..200 * 150).map(pixel).collect() }
    }

    #[test]
    fn a_gradient_has_none_and_brightness_does_not_matter() {
        let slope = |scale: f32| made(move |x, y| scale * (0.005 * x + 0.002 * y).exp2());
        // The result bends slightly at the edges, due to repeated edge values.
        let even = spots(&slope(1.0), ALL);
        assert!(even.greatest < 5.0 && even.deviation < 1.0, "{even:?}");
        let waves = |scale: f32| made(move |x, y| scale * (1.0 + 0.05 * (x / 3.0).sin() * (y / 3.0).sin()));
        let [bright, dark] = [100.0, 1.0].map(|scale| spots(&waves(scale), ALL));
        assert!((bright.deviation - dark.deviation).abs() < 1e-3 && bright.deviation > 10.0, "{bright:?}");
    }

    #[test]
    fn one_spot_shows_in_its_rectangle_alone() {
        // A tenth of a stop, 3 pixels wide.
        let spot = |x: f32, y: f32| (0.1 * (-((x - 60.0).powi(2) + (y - 70.0).powi(2)) / 18.0).exp()).exp2();
        let picture = made(spot);
        let found = spots(&picture, [0.1, 0.2, 0.5, 0.7]);
        assert!(found.greatest > 40.0 && found.greatest < 100.0, "{found:?}");
        assert!(spots(&picture, [0.6, 0.2, 1.0, 0.7]).greatest < 0.1);
    }
}
