//! Antialiasing of edges in a picture with one sample per pixel, as in smooth.wgsl of the viewer during motion:
//! Lottes 2011, FXAA 3.11.

use glam::{Vec2, Vec3};

/// Contrast threshold of perceptual brightness for smoothing an edge.
const CONTRAST: f32 = 0.03;
/// Maximum search distance along an edge, on each side, pixels.
const REACH: f32 = 8.0;
/// Exponent of the blend for features thinner than a pixel: 2 in FXAA, smaller against flicker in motion.
const THIN: f32 = 1.75;

/// A picture: linear display values in rows from the top.
#[derive(Clone, Copy, Debug)]
pub struct Pixels<'a> {
    /// Width in pixels, also the length of a row.
    pub width: usize,
    /// Pixels, row by row.
    pub pixels: &'a [Vec3],
}

impl Pixels<'_> {
    /// Returns a pixel; coordinates are clamped to the picture.
    fn at(&self, x: i32, y: i32) -> Vec3 {
        let inside = |v: i32, end: usize| v.clamp(0, end as i32 - 1) as usize;
        let rows = self.pixels.len() / self.width;
        self.pixels[inside(y, rows) * self.width + inside(x, self.width)]
    }

    /// Returns the bilinear value; pixel centres are at half-integers.
    fn bilinear(&self, place: Vec2) -> Vec3 {
        let low = (place - 0.5).floor();
        let share = place - 0.5 - low;
        let row = |y: i32| self.at(low.x as i32, y).lerp(self.at(low.x as i32 + 1, y), share.x);
        row(low.y as i32).lerp(row(low.y as i32 + 1), share.y)
    }

    /// Returns the brightness of the bilinear value.
    fn brightness(&self, place: Vec2) -> f32 {
        brightness(self.bilinear(place))
    }

    /// Searches for the end of an edge from `start` in steps of `along`, one pixel long. Returns the distance and the
    /// difference of brightness from `mean` at that distance, at least `least` in magnitude at the end of the edge.
    fn edge_end(&self, start: Vec2, along: Vec2, mean: f32, least: f32) -> (f32, f32) {
        let (mut far, mut off) = (0.0, 0.0f32);
        while far < REACH && off.abs() < least {
            far += 1.0;
            off = self.brightness(start + far * along) - mean;
        }
        (far, off)
    }

    /// Returns the value at a place (pixels from the left and from the top), shifted across an edge by the share of
    /// the pixel beyond the edge.
    pub fn smoothed(&self, place: Vec2) -> Vec3 {
        let own = self.bilinear(place);
        let m = brightness(own);
        let at = |x: f32, y: f32| self.brightness(place + Vec2::new(x, y));
        let beside = [at(-1.0, 0.0), at(1.0, 0.0), at(0.0, -1.0), at(0.0, 1.0)];
        let corners = [at(-1.0, -1.0), at(1.0, -1.0), at(-1.0, 1.0), at(1.0, 1.0)];
        let range = beside.into_iter().fold(m, f32::max) - beside.into_iter().fold(m, f32::min);
        if range < CONTRAST {
            return own;
        }
        let bend = |a: f32, middle: f32, b: f32| (a + b - 2.0 * middle).abs();
        let ([left, right, above, below], [a, b, c, d]) = (beside, corners);
        let rows = 2.0 * bend(above, m, below) + bend(a, left, c) + bend(b, right, d);
        let columns = 2.0 * bend(left, m, right) + bend(a, above, b) + bend(c, below, d);
        let (along, across, pair) = if rows >= columns {
            (Vec2::X, Vec2::Y, [above, below])
        } else {
            (Vec2::Y, Vec2::X, [left, right])
        };
        let first = (pair[0] - m).abs() >= (pair[1] - m).abs();
        let (across, other) = if first { (-across, pair[0]) } else { (across, pair[1]) };
        let (mean, least) = (0.5 * (m + other), 0.25 * (other - m).abs());
        let back = self.edge_end(place + 0.5 * across, -along, mean, least);
        let on = self.edge_end(place + 0.5 * across, along, mean, least);
        let end = if back.0 < on.0 { back } else { on };
        // If the nearer end is on this pixel's side, the edge cuts a different pixel.
        let edge = if (m < mean) == (end.1 < 0.0) { 0.0 } else { 0.5 - end.0 / (back.0 + on.0) };
        // A pixel that differs from its entire neighbourhood is a feature thinner than a pixel.
        let sum = |of: [f32; 4]| of.into_iter().sum::<f32>();
        let thin = ((2.0 * sum(beside) + sum(corners)) / 12.0 - m).abs() / range;
        let thin = thin.min(1.0).powi(2) * (3.0 - 2.0 * thin.min(1.0));
        self.bilinear(place + across * edge.max(thin.powf(THIN)))
    }

    /// Returns the smoothed picture.
    pub fn all_smoothed(&self) -> Vec<Vec3> {
        let place = |i: usize| Vec2::new((i % self.width) as f32, (i / self.width) as f32) + 0.5;
        (0..self.pixels.len()).map(|i| self.smoothed(place(i))).collect()
    }
}

/// Returns perceptual brightness of linear display values.
fn brightness(color: Vec3) -> f32 {
    color.clamp(Vec3::ZERO, Vec3::ONE).dot(Vec3::new(0.2126, 0.7152, 0.0722)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 48;

    /// Picture that is bright above a line of this slope through the middle: the mean of `samples` × `samples` per
    /// pixel.
    fn edge(slope: f32, samples: usize) -> Vec<Vec3> {
        let share = |i: usize| {
            let [x, y] = [i % SIDE, i / SIDE].map(|v| v as f32 - SIDE as f32 / 2.0);
            let at = |k: usize| (k as f32 + 0.5) / samples as f32;
            let is_above = |k: &usize| y + at(k / samples) < slope * (x + at(k % samples)) + 0.3;
            (0..samples * samples).filter(is_above).count() as f32 / (samples * samples) as f32
        };
        (0..SIDE * SIDE).map(|i| Vec3::splat(0.1).lerp(Vec3::new(0.8, 0.7, 0.6), share(i))).collect()
    }

    fn smoothed(pixels: &[Vec3]) -> Vec<Vec3> {
        Pixels { width: SIDE, pixels }.all_smoothed()
    }

    fn mean(pixels: &[Vec3]) -> Vec3 {
        pixels.iter().sum::<Vec3>() / pixels.len() as f32
    }

    fn apart(a: &[Vec3], b: &[Vec3]) -> f32 {
        a.iter().zip(b).map(|(a, b)| a.distance_squared(*b)).sum::<f32>().sqrt()
    }

    #[test]
    fn what_is_flat_or_nearly_so_stays_as_it_is() {
        let ramp: Vec<_> = (0..SIDE * SIDE).map(|i| Vec3::splat(0.2 + 0.005 * (i % SIDE) as f32)).collect();
        for pixels in [vec![Vec3::new(0.3, 0.9, 0.1); SIDE * SIDE], ramp] {
            let out = smoothed(&pixels);
            assert!(pixels.iter().zip(&out).all(|(a, b)| a.distance(*b) < 1e-6));
        }
    }

    #[test]
    fn an_edge_keeps_its_mean_and_comes_nearer_to_what_many_samples_show() {
        for slope in [0.0, 0.13, 0.3, -0.45, 0.8, 1.0, -2.5] {
            let (one, many) = (edge(slope, 1), edge(slope, 16));
            let out = smoothed(&one);
            assert!(mean(&out).distance(mean(&one)) < 0.004, "{slope}: {} {}", mean(&out), mean(&one));
            if slope != 0.0 {
                let [before, after] = [&one, &out].map(|picture| apart(picture, &many));
                println!("{slope}: {before} {after}");
                assert!(after < 0.8 * before, "{slope}: {after}, before {before}");
            }
        }
    }
}
