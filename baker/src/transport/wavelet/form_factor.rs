//! Form factor of a quadrilateral in closed form.

use super::patch::PatchPoint;
use glam::DVec3;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::TAU;

/// Irradiance of a point from a planar, convex quadrilateral of radiosity 1, of either direction around:
/// Lambert's formula (1760), Σ Γᵢ · n / 2π with Γᵢ the angle that edge i subtends times the unit normal of
/// its plane through the point. What lies below the receiver's horizon is cut off.
pub(super) fn form_factor(corners: &[DVec3; 4], receiver: &PatchPoint) -> f64 {
    let corners = corners.map(|corner| corner - receiver.position);
    let heights = corners.map(|corner| corner.dot(receiver.normal));
    // A line cuts a quadrilateral to five corners at most.
    let mut above = [DVec3::ZERO; 5];
    let mut count = 0;
    let mut push = |corner: DVec3| {
        if count < above.len() {
            above[count] = corner;
            count += 1;
        }
    };
    for i in 0..4 {
        let next = (i + 1) % 4;
        if heights[i] > 0.0 {
            push(corners[i]);
        }
        if (heights[i] > 0.0) != (heights[next] > 0.0) {
            push(corners[i].lerp(corners[next], heights[i] / (heights[i] - heights[next])));
        }
    }
    let above = &above[..count];
    let edge = |(a, b): (&DVec3, &DVec3)| {
        let cross = a.cross(*b);
        let sine = cross.length();
        if sine > 0.0 { sine.arc_tangent2(a.dot(*b)) * cross.dot(receiver.normal) / sine } else { 0.0 }
    };
    let sum: f64 = above.iter().zip(above.iter().cycle().skip(1)).map(edge).sum();
    sum.abs() / TAU
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(position: DVec3, normal: DVec3) -> PatchPoint {
        PatchPoint { position, normal, seen_from: position, seen_normal: normal }
    }

    #[test]
    fn squares_above_and_beside() {
        let square = |x: f64, z: f64, y: f64| {
            [[0.0, 0.0], [x, 0.0], [x, z], [0.0, z]].map(|[x, z]| DVec3::new(x, y, z))
        };
        // Parallel, above a corner (Howell, B-4).
        let [a, b] = [0.7_f64, 1.3_f64];
        let [x, y] = [1.0 + a * a, 1.0 + b * b].map(f64::sqrt);
        let expected = (a / x * (b / x).arc_tangent() + b / y * (a / y).arc_tangent()) / TAU;
        let found = form_factor(&square(a, b, 1.0), &at(DVec3::ZERO, DVec3::Y));
        assert!((found - expected).abs() < 1e-14, "{found} {expected}");
        // A wall that fills a quarter of the sphere.
        let wall = [[-1e6, 0.0], [1e6, 0.0], [1e6, 1e6], [-1e6, 1e6]].map(|[x, y]| DVec3::new(x, y, 1e-3));
        let found = form_factor(&wall, &at(DVec3::ZERO, DVec3::Y));
        assert!((found - 0.5).abs() < 1e-6, "{found}");
        // Half of a square is below the horizon.
        let upright =
            [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
        let upper = [[-1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [-1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 1.0));
        let point = at(DVec3::ZERO, DVec3::Y);
        assert!((form_factor(&upright, &point) - form_factor(&upper, &point)).abs() < 1e-15);
        assert_eq!(form_factor(&upright, &at(DVec3::ZERO, DVec3::NEG_Z)), 0.0);
    }
}
