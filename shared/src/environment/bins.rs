//! Equal-area bins of the sphere: Clarberg, *Fast Equal-Area Mapping of the (Hemi)Sphere Using SIMD*, Journal of
//! Graphics Tools 13(3), 2008.
//!
//! The square of the equal-area octahedral map is a grid of 16 by 16 bins, in Morton order: bins 4k to 4k + 3 are one
//! bin of the next coarser grid. The map's axis is z, so that the horizon (y = 0) runs along borders of bins: bins 128
//! to 255 are above it, and no bin mixes sky with ground.

use super::picture::{Environment, azimuth, direction_of, environment_from_world, polar, solid_angle};
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::{FRAC_2_PI, FRAC_PI_4, PI};

/// Bins in a row of the grid.
const SIDE: usize = 16;
/// Bins of the sphere.
pub const BINS: usize = SIDE * SIDE;
/// Solid angle of a bin, sr.
pub const SOLID_ANGLE: f32 = 4.0 * PI / BINS as f32;
/// A pixel at a bin's border has samples of a bin's solid angle over this number.
const SAMPLES: f64 = 4096.0;
/// Samples along a side of a pixel at a bin's border, at least and at most.
const LEAST: u32 = 8;
const MOST: u32 = 256;

/// The equal-area octahedral map: a unit vector to the square `[0, 1]²`.
pub fn encode(direction: Vec3) -> Vec2 {
    let a = direction.abs();
    // sqrt(1 − |z|), without the loss of digits near the axis.
    let radius = ((a.x * a.x + a.y * a.y) / (1.0 + a.z)).sqrt();
    let (large, small) = (a.x.max(a.y), a.x.min(a.y));
    let angle = if large > 0.0 { (small / large).atan() * FRAC_2_PI } else { 0.0 };
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
    let (sin, cos) = angle.sin_cos();
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

/// Mean radiance of an environment in each bin of world space, W/(sr m²), RGB: [`Projection`], used once.
pub fn project(environment: &Environment, rotation_deg: f32) -> [Vec3; BINS] {
    Projection::new(environment.width, environment.height).project(environment, rotation_deg)
}

/// Least number of columns for which a rotation shifts whole columns; pictures of fewer have each repeated.
const COLUMNS: u32 = 128;

/// Part of a pixel that lies in a bin.
#[derive(Clone, Copy, Debug)]
struct Overlap {
    column: u32,
    row: u32,
    bin: u16,
    /// sr.
    solid_angle: f64,
}

/// From the pixels of pictures of one size to bins: for each pixel the solid angle that it shares with a bin.
///
/// A pixel is a piece of sphere of one radiance. A pixel within a bin counts with its solid angle; one that reaches over
/// a border is divided by samples of equal solid angle. Rotation shifts the picture by columns: between two whole shifts
/// both are interpolated, so that turning an environment costs two sums over the overlaps.
#[derive(Clone, Debug)]
pub struct Projection {
    /// How often each column is repeated.
    repeat: u32,
    overlaps: Vec<Overlap>,
    /// Solid angle of all overlaps of a bin.
    solid_angles: Vec<f64>,
}

impl Projection {
    /// Measures the overlaps of pixels and bins.
    pub fn new(width: u32, height: u32) -> Self {
        let repeat = COLUMNS.div_ceil(width);
        let width = width * repeat;
        let bin = |azimuth, polar| bin_of(direction_of(azimuth, polar)) as u16;
        let corners = |y: u32| -> Vec<u16> {
            let polar = polar(f64::from(y) / f64::from(height));
            (0..=width).map(|x| bin(azimuth(f64::from(x) / f64::from(width)), polar)).collect()
        };
        let mut overlaps: Vec<Overlap> = Vec::new();
        let mut solid_angles = vec![0.0; BINS];
        let mut top = corners(0);
        for row in 0..height {
            let bottom = corners(row + 1);
            let solid_angle = solid_angle(row, width, height);
            let side = (solid_angle / f64::from(SOLID_ANGLE) * SAMPLES).sqrt().ceil();
            let side = (side as u32).clamp(LEAST, MOST);
            let rows = equal_bands(row, height, side);
            for column in 0..width {
                let mut add = |bin: u16, solid_angle: f64| {
                    solid_angles[bin as usize] += solid_angle;
                    let of_pixel = overlaps.iter_mut().rev();
                    let mut of_pixel = of_pixel.take_while(|last| (last.column, last.row) == (column, row));
                    match of_pixel.find(|last| last.bin == bin) {
                        Some(last) => last.solid_angle += solid_angle,
                        None => overlaps.push(Overlap { column, row, bin, solid_angle }),
                    }
                };
                let x = column as usize;
                let [a, b, c, d] = [top[x], top[x + 1], bottom[x], bottom[x + 1]];
                // A pixel whose corners are far apart may hold a bin between them.
                if a == b && a == c && a == d && solid_angle < 0.25 * f64::from(SOLID_ANGLE) {
                    add(a, solid_angle);
                    continue;
                }
                let part = solid_angle / f64::from(side * side);
                let within =
                    |i: u32| (f64::from(column) + (f64::from(i) + 0.5) / f64::from(side)) / f64::from(width);
                let columns: Vec<_> = (0..side).map(|i| azimuth(within(i))).collect();
                for polar in &rows {
                    columns.iter().for_each(|azimuth| add(bin(*azimuth, *polar), part));
                }
            }
            top = bottom;
        }
        Self { repeat, overlaps, solid_angles }
    }

    /// Mean radiance of an environment of this size in each bin of world space, W/(sr m²), RGB. Sums are divided by the
    /// solid angle that they were taken over, so a constant stays constant; then one factor a channel, within 0.2% of 1,
    /// keeps the environment's [`energy`](Environment::energy).
    pub fn project(&self, environment: &Environment, rotation_deg: f32) -> [Vec3; BINS] {
        let width = environment.width * self.repeat;
        let shift = (f64::from(rotation_deg) / 360.0).rem_euclid(1.0) * f64::from(width);
        let share = shift.fract();
        let first = shift as u32;
        // World column x shows the environment's column x + shift: the picture goes from +x over −z.
        let mut sums = [DVec3::ZERO; BINS];
        for Overlap { column, row, bin, solid_angle } in &self.overlaps {
            let at =
                |more: u32| environment.at((column + first + more) % width / self.repeat, *row).as_dvec3();
            let radiance = if share == 0.0 { at(0) } else { at(0).lerp(at(1), share) };
            sums[*bin as usize] += radiance * *solid_angle;
        }
        let mut means: [Vec3; BINS] = std::array::from_fn(|i| {
            if self.solid_angles[i] > 0.0 {
                (sums[i] / self.solid_angles[i]).as_vec3()
            } else {
                let there = direction(i, Vec2::splat(0.5));
                environment.radiance(environment_from_world(there, rotation_deg))
            }
        });
        let (before, after) = (environment.energy(), energy(&means));
        let factor = DVec3::select(after.cmpgt(DVec3::ZERO), before / after, DVec3::ONE).as_vec3();
        means.iter_mut().for_each(|mean| *mean *= factor);
        means
    }
}

/// Integral of the radiance of bins over the sphere, W/m², RGB.
pub fn energy(bins: &[Vec3; BINS]) -> DVec3 {
    bins.iter().map(|bin| bin.as_dvec3()).sum::<DVec3>() * f64::from(SOLID_ANGLE)
}

/// Sines and cosines of the polar angle in the middles of `count` bands of equal solid angle in a row of the picture.
fn equal_bands(row: u32, height: u32, count: u32) -> Vec<(f64, f64)> {
    let cosine = |y: u32| (f64::from(y) / f64::from(height) * std::f64::consts::PI).cos();
    let (top, bottom) = (cosine(row), cosine(row + 1));
    let middle = |i: u32| top + (bottom - top) * (f64::from(i) + 0.5) / f64::from(count);
    (0..count).map(|i| polar(middle(i).clamp(-1.0, 1.0).acos() / std::f64::consts::PI)).collect()
}

#[cfg(test)]
mod tests;
