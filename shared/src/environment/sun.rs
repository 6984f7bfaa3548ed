//! A sun in an environment becomes a directional light: its disk is so small and bright that bins would spread its
//! light over a hundred times its solid angle.

use super::bins;
use super::picture::{Environment, disk_radius_deg};
use crate::colour::luminance;
use crate::elementary::Elementary;
use glam::{DVec3, Vec3};

/// A disk of light infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// Towards the sun, unit length, environment space.
    pub direction: Vec3,
    /// Irradiance of a surface that faces the sun, W/m², linear RGB.
    pub irradiance: Vec3,
    /// Angular radius, degrees.
    pub radius_deg: f32,
}

/// The surroundings of a sun are the ring between these distances from its brightest pixel, degrees. All of the sun is
/// within the ring.
const RING_DEG: [f32; 2] = [10.0, 14.0];
/// A pixel belongs to the sun if its luminance is above this many times that of the surroundings.
const CONTRAST: f32 = 10.0;
/// A sun gives at least this share of the light (the integral of the radiance) of the upper hemisphere.
const LEAST_SHARE: f64 = 0.05;
/// Largest solid angle of a sun, in bins: a disk of 5.1° radius.
const MOST_BINS: f64 = 0.5;
/// Smallest and largest radius of a sun, degrees: as small as shadow maps can show, and as large as a ring allows.
const RADII_DEG: [f64; 2] = [0.1, 6.0];

/// Takes the sun out of an environment; without one, the environment stays as it is.
///
/// A sun is a connected region around the brightest pixel, above the horizon, in which the luminance is over
/// ten times the median of its surroundings, a ring from 10° to 14°. It lies within the ring; its excess over the
/// surroundings is at least 5% of the light of the upper hemisphere; and a disk of its half-power solid angle, doubled,
/// is at most half of a bin. The region then has the radiance of the surroundings, and the sun what was taken away:
/// the [`energy`](Environment::energy) of both together is the energy before. A window or a softbox is too wide, a
/// clouded sky and a lamp among others too faint; those the bins show.
pub fn extract_sun(environment: &Environment) -> (Environment, Option<Sun>) {
    match find(environment) {
        Some((rest, sun)) => (rest, Some(sun)),
        None => (environment.clone(), None),
    }
}

fn find(environment: &Environment) -> Option<(Environment, Sun)> {
    let luminances = environment.luminances();
    let first = (0..luminances.len()).max_by(|&a, &b| luminances[a].total_cmp(&luminances[b]))?;
    let middle = direction_of(environment, first);
    if middle.y <= 0.0 || luminances[first].partial_cmp(&0.0)?.is_le() {
        return None;
    }
    let (surroundings, median) = surroundings(environment, &luminances, middle)?;
    let region = region(environment, &luminances, first, CONTRAST * median)?;

    let mut rest = environment.clone();
    let taken: Vec<(usize, f64, DVec3)> = region
        .into_iter()
        .map(|pixel| {
            let before = environment.pixels[pixel];
            let after = before.min(surroundings);
            rest.pixels[pixel] = after;
            let solid_angle = environment.solid_angle((pixel / environment.width as usize) as u32);
            (pixel, solid_angle, (before.as_dvec3() - after.as_dvec3()) * solid_angle)
        })
        .collect();
    let irradiance: DVec3 = taken.iter().map(|(_, _, light)| light).sum();
    let half = environment.height / 2;
    let upper = environment.integral(|_, y| f64::from(u8::from(y < half)));
    let brightness = |light: DVec3| f64::from(luminance(light.as_vec3()));
    if brightness(irradiance) < LEAST_SHARE * brightness(upper) {
        return None;
    }
    let solid_angle = 2.0 * half_power(&taken);
    if solid_angle > MOST_BINS * f64::from(bins::SOLID_ANGLE) {
        return None;
    }
    let toward: DVec3 = taken
        .iter()
        .map(|(pixel, _, light)| direction_of(environment, *pixel).as_dvec3() * brightness(*light))
        .sum();
    let radius_deg = disk_radius_deg(solid_angle).clamp(RADII_DEG[0], RADII_DEG[1]) as f32;
    let sun = Sun { direction: toward.normalize().as_vec3(), irradiance: irradiance.as_vec3(), radius_deg };
    Some((rest, sun))
}

fn direction_of(environment: &Environment, pixel: usize) -> Vec3 {
    let width = environment.width as usize;
    environment.direction((pixel % width) as u32, (pixel / width) as u32)
}

/// Median radiance, by luminance, of the ring around a direction, and its luminance; `None` where pixels are too large
/// to tell.
fn surroundings(environment: &Environment, luminances: &[f32], middle: Vec3) -> Option<(Vec3, f32)> {
    let [inner, outer] = RING_DEG.map(|degrees| degrees.to_radians().cosine());
    let is_near = |pixel: &usize| (outer..inner).contains(&direction_of(environment, *pixel).dot(middle));
    let rows = rows_around(environment, middle);
    let ring: Vec<usize> = rows.filter(is_near).collect();
    if ring.len() < 4 {
        return None;
    }
    let median = median(ring.iter().map(|pixel| luminances[*pixel]));
    let pixel = ring.into_iter().find(|pixel| luminances[*pixel].max(0.0) == median)?;
    Some((environment.pixels[pixel], median))
}

/// Median of numbers that are not negative: bisection over their bits, which ascend with them. A sort would be the
/// largest part of the viewer's code for environments.
fn median(numbers: impl Iterator<Item = f32> + Clone) -> f32 {
    let half = numbers.clone().count() / 2;
    let (mut low, mut high) = (0, f32::INFINITY.to_bits());
    while low < high {
        let middle = low + (high - low) / 2;
        let below = numbers.clone().filter(|number| number.max(0.0).to_bits() <= middle).count();
        if below > half { high = middle } else { low = middle + 1 }
    }
    f32::from_bits(low)
}

/// Pixels of the rows that the ring around a direction meets.
fn rows_around(environment: &Environment, middle: Vec3) -> impl Iterator<Item = usize> {
    let row_deg = 180.0 / environment.height as f32;
    let polar_deg = middle.y.clamp(-1.0, 1.0).arc_cosine().to_degrees();
    let first = ((polar_deg - RING_DEG[1]) / row_deg).floor().max(0.0) as usize;
    let last = ((polar_deg + RING_DEG[1]) / row_deg).ceil().min(environment.height as f32) as usize;
    let width = environment.width as usize;
    first * width..last * width
}

/// Pixels above a luminance that are connected to the first one (by sides and corners); `None` if they reach the ring.
fn region(environment: &Environment, luminances: &[f32], first: usize, above: f32) -> Option<Vec<usize>> {
    let (width, height) = (environment.width as usize, environment.height as usize);
    let inner = RING_DEG[0].to_radians().cosine();
    let middle = direction_of(environment, first);
    let mut is_met = vec![false; luminances.len()];
    is_met[first] = true;
    let (mut found, mut next) = (vec![first], 0);
    while let Some(&pixel) = found.get(next) {
        next += 1;
        if direction_of(environment, pixel).dot(middle) < inner {
            return None;
        }
        let (x, y) = (pixel % width, pixel / width);
        for row in y.saturating_sub(1)..=(y + 1).min(height - 1) {
            for column in [x + width - 1, x, x + 1] {
                let neighbour = row * width + column % width;
                if !is_met[neighbour] && luminances[neighbour] > above {
                    is_met[neighbour] = true;
                    found.push(neighbour);
                }
            }
        }
    }
    Some(found)
}

/// Solid angle of the brightest part that has half of the light, sr; a pixel counts in part.
fn half_power(taken: &[(usize, f64, DVec3)]) -> f64 {
    let light = |light: &DVec3| f64::from(luminance(light.as_vec3()));
    let mut parts: Vec<(f64, f64)> = taken.iter().map(|(_, area, l)| (*area, light(l))).collect();
    let mut left = 0.5 * parts.iter().map(|(_, light)| light).sum::<f64>();
    let mut solid_angle = 0.0;
    // The brightest part first.
    while let Some(at) = (0..parts.len()).reduce(|a, b| {
        let radiance = |at: usize| parts[at].1 / parts[at].0;
        if radiance(b) > radiance(a) { b } else { a }
    }) {
        let (area, light) = parts.swap_remove(at);
        if light >= left {
            return solid_angle + area * left / light.max(f64::MIN_POSITIVE);
        }
        left -= light;
        solid_angle += area;
    }
    solid_angle
}

#[cfg(test)]
mod tests;
