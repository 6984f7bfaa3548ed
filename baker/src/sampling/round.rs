//! Rounding of numbers to the file's precision before further computation: so the file loses nothing, and baker and
//! viewer see equal functions.

use crate::geometry::Hit;
use crate::scene::steps::{power_of_two_under, to_steps};
use glam::Vec3;
use rebounce_shared::octahedral::{pack_rounded, unpack_snorm16};

/// Rounds a hit's position and shading normal. The position moves by less than half of `epsilon`, the offset of ray
/// origins from the surface, unless the step `least` is larger.
pub(super) fn rounded(hit: &Hit, epsilon: f32, least: f32) -> (Vec3, Vec3) {
    let step = (0.5 * power_of_two_under(epsilon)).max(least);
    (to_steps(hit.position, step), unpack_snorm16(pack_rounded(hit.normal)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;
    use rebounce_shared::octahedral::pack_snorm16;

    #[test]
    fn rounding_moves_little_and_once() {
        for i in 0..5000 {
            let mut s = Stream::new(11, i);
            let (position, normal) = (Vec3::new(s.unit(), s.unit(), s.unit()) * 90.0 - 45.0, s.sphere());
            let epsilon = 1e-4 * (1.0 + s.unit());
            let hit = |position, normal| Hit {
                distance: 1.0,
                position,
                geometric_normal: normal,
                normal,
                albedo: Vec3::ONE,
                emission: Vec3::ZERO,
                emitter: None,
                is_unlit: false,
                group: 0,
                lightmap: None,
                gloss: crate::geometry::Gloss::MATT,
            };
            let (p, n) = rounded(&hit(position, normal), epsilon, 0.0);
            assert!(p.distance(position) < 0.5 * epsilon && n.dot(normal) > 0.999_998, "{position} {normal}");
            assert_eq!(rounded(&hit(p, n), epsilon, 0.0), (p, n));
            // The file's bits decode to the same normal.
            assert_eq!(unpack_snorm16(pack_snorm16(n)), n);
        }
        assert_eq!(to_steps(Vec3::splat(-1e-9), 0.5).to_array().map(f32::to_bits), [0; 3]);
        assert_eq!(power_of_two_under(0.7), 0.5);
    }
}
