//! Equal-area bins of the sphere: Clarberg, *Fast Equal-Area Mapping of the (Hemi)Sphere Using SIMD*, Journal of
//! Graphics Tools 13(3), 2008.
//!
//! The square of the equal-area octahedral map is a grid of 16 by 16 bins, in Morton order: bins 4k to 4k + 3 are one
//! bin of the next coarser grid. The map's axis is z, so that the horizon (y = 0) runs along borders of bins: bins 128
//! to 255 are above it, and no bin mixes sky with ground.

use super::picture::{Environment, azimuth, direction_of, polar, turned};
use crate::elementary::Elementary;
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::{FRAC_2_PI, FRAC_PI_4, PI};

/// Bins in a row of the grid.
const SIDE: usize = 16;
/// Bins of the sphere.
pub const BINS: usize = SIDE * SIDE;
/// Solid angle of a bin, sr.
pub const SOLID_ANGLE: f32 = 4.0 * PI / BINS as f32;
/// A pixel at a bin's border has samples of a bin's solid angle over this number.
const SAMPLES: f64 = 512.0;
/// Samples along a side of a pixel at a bin's border, at least and at most.
const LEAST: u32 = 4;
const MOST: u32 = 256;
/// Rows of samples in a picture, at least: pictures of a few rows have pixels that go through many bins.
const ROWS: u32 = 128;

/// The equal-area octahedral map: a unit vector to the square `[0, 1]²`.
pub fn encode(direction: Vec3) -> Vec2 {
    let a = direction.abs();
    // sqrt(1 − |z|), without the loss of digits near the axis.
    let radius = ((a.x * a.x + a.y * a.y) / (1.0 + a.z)).sqrt();
    let (large, small) = (a.x.max(a.y), a.x.min(a.y));
    let angle = if large > 0.0 { (small / large).arc_tangent() * FRAC_2_PI } else { 0.0 };
    let angle = if a.x < a.y { 1.0 - angle } else { angle };
    let v = angle * radius;
    let u = radius - v;
    let (u, v) = if direction.z < 0.0 { (1.0 - v, 1.0 - u) } else { (u, v) };
    Vec2::new(u.copysign(direction.x), v.copysign(direction.y)) * 0.5 + 0.5
}

/// The inverse of [`encode`]; equal areas of the square become equal solid angles.
pub fn decode(place: Vec2) -> Vec3 {
    let p = place * 2.0 - 1.0;
    let (u, v) = (p.x.abs(), p.y.abs());
    let inside = 1.0 - u - v;
    let radius = 1.0 - inside.abs();
    let angle = if radius > 0.0 { ((v - u) / radius + 1.0) * FRAC_PI_4 } else { 0.0 };
    let (sin, cos) = angle.sine_cosine();
    let across = radius * (2.0 - radius * radius).max(0.0).sqrt();
    let z = (1.0 - radius * radius).copysign(inside);
    Vec3::new((cos * across).copysign(p.x), (sin * across).copysign(p.y), z).normalize()
}

/// The bin of a unit direction.
#[inline]
pub fn bin_of(direction: Vec3) -> usize {
    let place = encode(direction) * SIDE as f32;
    let cell = |x: f32| (x as usize).min(SIDE - 1);
    spread(cell(place.x)) | spread(cell(place.y)) << 1
}

/// A direction within a bin: uniform in solid angle for a uniform place in `[0, 1]²`.
pub fn direction(bin: usize, place: Vec2) -> Vec3 {
    let cell = Vec2::new(gather(bin) as f32, gather(bin >> 1) as f32);
    decode((cell + place) / SIDE as f32)
}

/// Inserts a zero bit between neighbouring bits of a four-bit number.
fn spread(x: usize) -> usize {
    let x = (x | x << 2) & 0b0011_0011;
    (x | x << 1) & 0b0101_0101
}

/// The inverse of [`spread`].
fn gather(x: usize) -> usize {
    let x = x & 0b0101_0101;
    let x = (x | x >> 1) & 0b0011_0011;
    (x | x >> 2) & 0b0000_1111
}

/// Mean radiance of an environment in each bin of world space, W/(sr m²), RGB.
///
/// A pixel is a piece of sphere of one radiance. A pixel within a bin counts with its solid angle; one that reaches over
/// a border is divided by samples of equal solid angle. Sums are divided by the solid angle that they were taken over,
/// so a constant stays constant; then one factor a channel, within 0.2% of 1, keeps the environment's
/// [`energy`](Environment::energy).
pub fn project(environment: &Environment, rotation_deg: f32) -> [Vec3; BINS] {
    let (width, height) = (environment.width, environment.height);
    // Samples share sines and cosines, which would take most of the time.
    let turn = (-rotation_deg).to_radians().sine_cosine();
    let bin = |azimuth, polar| bin_of(turned(direction_of(azimuth, polar), turn)) as u16;
    let corners = |y: u32| -> Vec<u16> {
        let polar = polar(f64::from(y) / f64::from(height));
        (0..=width).map(|x| bin(azimuth(f64::from(x) / f64::from(width)), polar)).collect()
    };
    let (mut sums, mut solid_angles) = ([DVec3::ZERO; BINS], [0.0; BINS]);
    let mut top = corners(0);
    for y in 0..height {
        let bottom = corners(y + 1);
        let solid_angle = environment.solid_angle(y);
        let side = (solid_angle / f64::from(SOLID_ANGLE) * SAMPLES).sqrt().ceil();
        let side = (side as u32).clamp(LEAST.max(ROWS / height), MOST);
        let rows = equal_bands(y, height, side);
        for x in 0..width {
            let radiance = environment.at(x, y).as_dvec3();
            let mut add = |bin: u16, solid_angle: f64| {
                sums[bin as usize] += radiance * solid_angle;
                solid_angles[bin as usize] += solid_angle;
            };
            let column = x as usize;
            let [a, b, c, d] = [top[column], top[column + 1], bottom[column], bottom[column + 1]];
            // A pixel whose corners are far apart may hold a bin between them.
            if a == b && a == c && a == d && solid_angle < 0.25 * f64::from(SOLID_ANGLE) {
                add(a, solid_angle);
                continue;
            }
            let part = solid_angle / f64::from(side * side);
            let within = |i: u32| (f64::from(x) + (f64::from(i) + 0.5) / f64::from(side)) / f64::from(width);
            let columns: Vec<_> = (0..side).map(|i| azimuth(within(i))).collect();
            for polar in &rows {
                columns.iter().for_each(|azimuth| add(bin(*azimuth, *polar), part));
            }
        }
        top = bottom;
    }
    // Samples are so dense that every bin has some.
    let mut means: [Vec3; BINS] = std::array::from_fn(|i| (sums[i] / solid_angles[i]).as_vec3());
    let (before, after) = (environment.energy(), energy(&means));
    let factor = DVec3::select(after.cmpgt(DVec3::ZERO), before / after, DVec3::ONE).as_vec3();
    means.iter_mut().for_each(|mean| *mean *= factor);
    means
}

/// Integral of the radiance of bins over the sphere, W/m², RGB.
pub fn energy(bins: &[Vec3; BINS]) -> DVec3 {
    bins.iter().map(|bin| bin.as_dvec3()).sum::<DVec3>() * f64::from(SOLID_ANGLE)
}

/// Sines and cosines of the polar angle in the middles of `count` bands of equal solid angle in a row of the picture.
fn equal_bands(row: u32, height: u32, count: u32) -> Vec<(f64, f64)> {
    let cosine = |y: u32| (f64::from(y) / f64::from(height) * std::f64::consts::PI).cosine();
    let (top, bottom) = (cosine(row), cosine(row + 1));
    let middle = |i: u32| top + (bottom - top) * (f64::from(i) + 0.5) / f64::from(count);
    (0..count).map(|i| polar(middle(i).clamp(-1.0, 1.0).arc_cosine() / std::f64::consts::PI)).collect()
}

#[cfg(test)]
mod tests;
