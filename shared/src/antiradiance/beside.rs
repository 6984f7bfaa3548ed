//! Antiradiance beside an operator: irradiance for display where something has moved.
//!
//! The operator is baked with moving patches at rest. For a patch with departure s from its place at rest, 0 to 1, the irradiance is
//!
//! ```text
//! E = E_now + (1 − s) (E_operator − E_rest)
//! ```
//!
//! with the irradiance by antiradiance now and at rest. Static patches have s = 0: errors shared by both solutions cancel. A patch away
//! from rest is lit elsewhere; the operator's light of its place at rest is wrong there.

use super::patches::Patch;
use glam::{Vec3, Vec4};

/// Bits of an entry of the table of patches by point, before those of the departure.
pub const PATCH_BITS: u32 = 24;

/// Departure of a patch from its place at rest, 0 to 1: distance in sides of a square of its area, plus distance of the unit normals
/// (1 at 60 degrees).
pub fn departure(at_rest: &Patch, now: &Patch) -> f32 {
    let side = at_rest.area().sqrt().max(f32::MIN_POSITIVE);
    let way = now.position().distance(at_rest.position()) / side;
    (way + now.normal.distance(at_rest.normal)).min(1.0)
}

/// The entry of a point with a patch, whose departure is rounded to 8 bits.
pub fn entry(patch: u32, departure: f32) -> u32 {
    patch | ((255.0 * departure).round() as u32) << PATCH_BITS
}

/// Change of the operator's irradiance: RGB to add, and in w the share of the operator's irradiance to remove.
pub fn change(now: Vec3, at_rest: Vec3, departure: f32) -> Vec4 {
    (now - (1.0 - departure) * at_rest).extend(departure)
}

/// Irradiance for display, from the operator's and a [`change`].
pub fn shown(by_operator: Vec3, change: Vec4) -> Vec3 {
    ((1.0 - change.w) * by_operator + change.truncate()).max(Vec3::ZERO)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_rest_light_is_the_operators_and_far_from_there_that_of_antiradiance() {
        let at_rest = Patch::around(Vec3::ZERO, Vec3::Y, 0.04, Vec3::ONE);
        let [operator, rest, now] = [0.5, 0.4, 0.7].map(Vec3::splat);
        let of = |place: Vec3, normal: Vec3, now: Vec3| {
            let patch = Patch::around(place, normal, 0.04, Vec3::ONE);
            shown(operator, change(now, rest, departure(&at_rest, &patch)))
        };
        assert_eq!(of(Vec3::ZERO, Vec3::Y, rest), operator);
        assert!(of(Vec3::X, Vec3::Y, now).abs_diff_eq(now, 1e-6));
        assert!(of(Vec3::ZERO, Vec3::X, now).abs_diff_eq(now, 1e-6));
        // Half a side away half of the difference is left.
        assert!(of(0.1 * Vec3::X, Vec3::Y, now).abs_diff_eq(Vec3::splat(0.75), 1e-6));
    }

    #[test]
    fn entries_hold_patches_and_departures() {
        for (patch, departure) in [(0, 0.0), (70_000, 0.4), ((1 << PATCH_BITS) - 1, 0.5)] {
            let entry = entry(patch, departure);
            assert_eq!(entry % (1 << PATCH_BITS), patch);
            assert!(((entry >> PATCH_BITS) as f32 / 255.0 - departure).abs() < 0.002);
        }
    }
}
