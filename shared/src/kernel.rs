//! The weight function of the meshless basis (paper, section 2.2).
//!
//! The viewer's `kernel.wgsl` has the same three formulas; a test compares the two.

use glam::Vec3;

/// Ratio of distance growth along the normal to growth along the tangent plane (`F_squash`, paper, Eq. 10).
pub const SQUASH: f32 = 2.0;

/// The fall-off `K` of Eq. 9: 1 at `t = 0`, 0 for `t ≥ 1`, smooth at both ends. `t` is distance over radius,
/// unitless.
#[inline]
pub fn falloff(t: f32) -> f32 {
    if t >= 1.0 { 0.0 } else { 1.0 + t * t * (2.0 * t - 3.0) }
}

/// Least cosine between the normals of overlapping functions: 60 degrees.
pub const LEAST_COSINE: f32 = 0.5;

/// Greatest sum of a level's weights that does not count as covering: shares of tiny sums would be noise.
pub const LEAST_WEIGHT: f32 = 1e-6;

/// Returns the similarity of two unit normals with this cosine, 1 for equal normals. The paper has the cosine's
/// square (Eq. 8); this function falls off faster, so that the faces of a bevelled edge keep their own light under a
/// lamp.
#[inline]
pub fn likeness(cosine: f32) -> f32 {
    let above = ((cosine - LEAST_COSINE) * (1.0 / (1.0 - LEAST_COSINE))).max(0.0);
    above * above
}

/// The squashed distance of Eq. 10, squared: ellipsoids around the point, flat along its normal.
/// `offset` is `x - x_j` and `normal_j` the point's unit normal; the result is in squared scene units.
#[inline]
pub fn squashed_distance_squared(offset: Vec3, normal_j: Vec3) -> f32 {
    (offset + SQUASH * offset.dot(normal_j) * normal_j).length_squared()
}

/// The weight `w_j(x, n)` of Eq. 8 for the point with this position, unit normal and radius.
/// Not negative; 0 outside the support and for normals 60 degrees or more apart.
#[inline]
pub fn weight(offset: Vec3, normal: Vec3, normal_j: Vec3, radius_j: f32) -> f32 {
    let cosine = normal.dot(normal_j);
    if cosine <= LEAST_COSINE {
        return 0.0;
    }
    let distance_squared = squashed_distance_squared(offset, normal_j);
    if distance_squared >= radius_j * radius_j {
        return 0.0;
    }
    falloff(distance_squared.sqrt() / radius_j) * likeness(cosine)
}

/// The symmetric 5D distance `D(p, q)` of Eq. 11, with [`likeness`] for the squared cosine, in scene units; infinite
/// for normals 60 degrees or more apart.
#[inline]
pub fn distance_5d(position_p: Vec3, normal_p: Vec3, position_q: Vec3, normal_q: Vec3) -> f32 {
    let cosine = normal_p.dot(normal_q);
    if cosine <= LEAST_COSINE {
        return f32::INFINITY;
    }
    let offset = position_p - position_q;
    let near = squashed_distance_squared(offset, normal_p).min(squashed_distance_squared(offset, normal_q));
    near.sqrt() / likeness(cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn falloff_is_one_at_the_centre_zero_at_the_rim_and_never_rises() {
        assert_eq!(falloff(0.0), 1.0);
        assert_eq!(falloff(1.0), 0.0);
        let mut last = 1.0;
        for i in 1..=1000 {
            let now = falloff(i as f32 / 1000.0);
            assert!(now <= last && now >= 0.0);
            last = now;
        }
    }

    #[test]
    fn distance_is_symmetric_and_grows_with_the_angle() {
        let (p, q) = (Vec3::new(0.1, 0.2, 0.3), Vec3::new(-0.4, 0.0, 0.9));
        let n = Vec3::Y;
        let m = Vec3::new(0.6, 0.8, 0.0);
        assert_eq!(likeness(1.0), 1.0);
        assert!(likeness(0.8) < 0.64 && likeness(0.8) > 0.0 && likeness(0.5) == 0.0);
        assert_eq!(distance_5d(p, n, q, m), distance_5d(q, m, p, n));
        assert!(distance_5d(p, n, q, m) >= distance_5d(p, n, q, n).min(distance_5d(p, m, q, m)));
        assert_eq!(distance_5d(p, n, q, Vec3::X), f32::INFINITY);
    }

    #[test]
    fn support_is_flat_along_the_normal() {
        let n = Vec3::Z;
        assert!(weight(Vec3::X * 0.9, n, n, 1.0) > 0.0);
        assert_eq!(weight(Vec3::Z * 0.34, n, n, 1.0), 0.0);
        assert!(weight(Vec3::Z * 0.32, n, n, 1.0) > 0.0);
        assert_eq!(weight(Vec3::ZERO, -n, n, 1.0), 0.0);
    }
}
