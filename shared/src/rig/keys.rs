//! Interpolation between keys (glTF 2.0, 3.11 and appendix C), with the same bits on every platform.

use crate::elementary::Elementary;
use glam::DQuat;

/// Value of a cubic Hermite spline at the share `s` of a step of so many seconds, from key `a` with its out-tangent to key `b` with
/// its in-tangent (glTF 2.0, appendix C.5).
pub fn cubic_hermite([a, leaving]: [f64; 2], [arriving, b]: [f64; 2], step: f64, s: f64) -> f64 {
    let (s2, s3) = (s * s, s * s * s);
    (2.0 * s3 - 3.0 * s2 + 1.0) * a
        + step * (s3 - 2.0 * s2 + s) * leaving
        + (3.0 * s2 - 2.0 * s3) * b
        + step * (s3 - s2) * arriving
}

/// Rotation at the share `s` between two quaternions x, y, z, w of any length, the shorter way round; no turn where one has no
/// direction.
pub fn between_rotations(a: [f64; 4], b: [f64; 4], s: f64) -> [f64; 4] {
    let [a, b] = [a, b].map(|q| DQuat::from_array(q).normalize());
    if a.is_finite() && b.is_finite() { slerp(a, b, s).to_array() } else { [0.0, 0.0, 0.0, 1.0] }
}

/// Spherical linear interpolation of unit quaternions the shorter way round (Shoemake 1985).
fn slerp(a: DQuat, b: DQuat, s: f64) -> DQuat {
    let cosine = a.dot(b);
    let (cosine, b) = if cosine < 0.0 { (-cosine, -b) } else { (cosine, b) };
    if cosine > 1.0 - f64::EPSILON {
        return (a * (1.0 - s) + b * s).normalize();
    }
    let angle = cosine.arc_cosine();
    (a * ((1.0 - s) * angle).sine() + b * (s * angle).sine()) * angle.sine().recip()
}
