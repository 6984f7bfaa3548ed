//! Edges smoothed in a picture of one sample a pixel, as the viewer does while something moves (smooth.wgsl), by Lottes
//! 2011, FXAA 3.11.

use glam::{Vec2, Vec3};

/// Contrast of brightness, as the eye counts, at which an edge is smoothed.
const CONTRAST: f32 = 0.03;
/// Pixels looked at along an edge, at most, on each side.
const REACH: f32 = 8.0;
/// Exponent of the blend for features thinner than a pixel: 2 in FXAA, smaller against flicker in motion.
const THIN: f32 = 1.75;

/// A picture: linear display values in rows from the top.
#[derive(Clone, Copy, Debug)]
pub struct Pixels<'a> {
    /// Pixels across; rows are as long.
    pub width: usize,
    /// As many rows as there are.
    pub pixels: &'a [Vec3],
}

impl Pixels<'_> {
    /// A pixel, the nearest one where `x` or `y` lies beside the picture.
    fn at(&self, x: i32, y: i32) -> Vec3 {
        let inside = |v: i32, end: usize| v.clamp(0, end as i32 - 1) as usize;
        let rows = self.pixels.len() / self.width;
        self.pixels[inside(y, rows) * self.width + inside(x, self.width)]
    }

    /// The value between pixels; centres at halves.
    fn bilinear(&self, place: Vec2) -> Vec3 {
        let low = (place - 0.5).floor();
        let share = place - 0.5 - low;
        let row = |y: i32| self.at(low.x as i32, y).lerp(self.at(low.x as i32 + 1, y), share.x);
        row(low.y as i32).lerp(row(low.y as i32 + 1), share.y)
    }

    /// Brightness at a place between pixels.
    fn brightness(&self, place: Vec2) -> f32 {
        brightness(self.bilinear(place))
    }

    /// How far an edge goes on from `start` by these steps of a pixel, and by how much its brightness is off `mean` there,
    /// by at least `least` where it ends.
    fn edge_end(&self, start: Vec2, along: Vec2, mean: f32, least: f32) -> (f32, f32) {
        let (mut far, mut off) = (0.0, 0.0f32);
        while far < REACH && off.abs() < least {
            far += 1.0;
            off = self.brightness(start + far * along) - mean;
        }
        (far, off)
    }

    /// The value at a place, pixels from the left and from the top: moved across an edge by the share of the pixel that
    /// lies beyond it.
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
        // Where the nearer end is on this pixel's side, the edge cuts another pixel.
        let edge = if (m < mean) == (end.1 < 0.0) { 0.0 } else { 0.5 - end.0 / (back.0 + on.0) };
        // What differs from all around it is thinner than a pixel.
        let sum = |of: [f32; 4]| of.into_iter().sum::<f32>();
        let thin = ((2.0 * sum(beside) + sum(corners)) / 12.0 - m).abs() / range;
        let thin = thin.min(1.0).powi(2) * (3.0 - 2.0 * thin.min(1.0));
        self.bilinear(place + across * edge.max(thin.powf(THIN)))
    }

    /// All pixels smoothed.
    pub fn all_smoothed(&self) -> Vec<Vec3> {
        let place = |i: usize| Vec2::new((i % self.width) as f32, (i / self.width) as f32) + 0.5;
        (0..self.pixels.len()).map(|i| self.smoothed(place(i))).collect()
    }
}

/// Brightness as the eye counts it, of linear display values.
fn brightness(color: Vec3) -> f32 {
    color.clamp(Vec3::ZERO, Vec3::ONE).dot(Vec3::new(0.2126, 0.7152, 0.0722)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 48;

    /// Bright above a line through the middle with this slope: the mean of so many samples a side of each pixel.
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
