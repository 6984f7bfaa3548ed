//! Sample places of direct light around a point: spread over the surface that the point represents, so that a
//! shadow's edge sweeps over it smoothly.
//!
//! The viewer's `footprint.wgsl` has the same formulas; a test compares the two.

use crate::elementary::Elementary;
use crate::kernel::likeness;
use crate::rbn::bulk::Cut;
use crate::surroundings::{SupportedPoint, Surroundings};
use glam::{Vec2, Vec3};

/// Number of direct light samples per point (the 2007 report, 6.2, averages 10).
pub const SAMPLES: u32 = 8;
/// Radius of the sample disk, relative to the support radius.
pub const RADIUS: f32 = 0.25;
/// Height of the samples above the point's tangent plane, relative to the support radius: a slightly curved surface
/// does not hide the samples.
pub const LIFT: f32 = 0.02;
/// Maximum depth of the surface below a sample, relative to the support radius.
const DEPTH: f32 = 0.15;

/// Returns two unit tangents perpendicular to a unit normal and to each other (Duff et al. 2017).
#[inline]
pub fn tangents(normal: Vec3) -> (Vec3, Vec3) {
    let sign = if normal.z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    let first = Vec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x);
    (first, Vec3::new(b, sign + normal.y * normal.y * a, -normal.y))
}

/// Returns the place of a sample in the unit disk: Vogel's spiral, with equal area per sample.
#[inline]
pub fn in_disk(sample: u32) -> Vec2 {
    const GOLDEN_ANGLE: f32 = 2.399_963_2;
    let radius = ((sample as f32 + 0.5) / SAMPLES as f32).sqrt();
    let (sin, cos) = (sample as f32 * GOLDEN_ANGLE).sine_cosine();
    Vec2::new(cos, sin) * radius
}

/// Returns a sample's offset from a point with this unit normal and support radius, scene units.
#[inline]
pub fn offset(sample: u32, normal: Vec3, support_radius: f32) -> Vec3 {
    let (first, second) = tangents(normal);
    let place = in_disk(sample) * RADIUS;
    support_radius * (first * place.x + second * place.y + normal * LIFT)
}

/// Returns the samples of a point's direct light, one bit per sample: those above the point's own surface, in sight of the
/// point and within its clip planes.
pub fn samples(
    surfaces: &(impl Surroundings + ?Sized),
    point: &SupportedPoint,
    cuts: &[Cut],
    seed: u32,
) -> u8 {
    let SupportedPoint { position, normal, radius, epsilon, .. } = *point;
    let above = position + normal * (LIFT * radius).max(epsilon);
    let belongs = |sample: u32| {
        let offset = offset(sample, normal, radius);
        let place = position + offset;
        if cuts.iter().any(|cut| cut.ends(offset)) || !surfaces.is_open(above, place) {
            return false;
        }
        let below = surfaces.cast(place, -normal, (LIFT + DEPTH) * radius, seed);
        below.is_some_and(|hit| hit.faces && likeness(hit.normal.dot(normal)) > 0.0)
    };
    (0..SAMPLES).filter(|sample| belongs(*sample)).fold(0, |bits, sample| bits | 1 << sample)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_lie_in_a_disk_around_the_point() {
        for normal in
            [Vec3::X, Vec3::NEG_Z, Vec3::Z, Vec3::new(0.36, -0.48, -0.8), Vec3::new(-0.6, 0.64, 0.48)]
        {
            let offsets: Vec<Vec3> = (0..SAMPLES).map(|k| offset(k, normal, 2.0)).collect();
            let mean = offsets.iter().sum::<Vec3>() / SAMPLES as f32;
            assert!((mean - 2.0 * LIFT * normal).length() < 0.06, "{mean}");
            for o in offsets {
                assert!((o.dot(normal) - 2.0 * LIFT).abs() < 1e-5);
                assert!((o - 2.0 * LIFT * normal).length() <= 2.0 * RADIUS);
            }
        }
    }
}
