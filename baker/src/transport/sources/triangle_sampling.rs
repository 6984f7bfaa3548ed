//! Samples of a triangle toward a receiver: uniform in solid angle (Arvo 1995, "Stratified Sampling of Spherical
//! Triangles"); uniform in area where the triangle is too small for the spherical formulas in single precision.

use glam::{Vec2, Vec3};
use rebounce_shared::elementary::Elementary;

/// Solid angle below which samples are uniform in area, steradians: the cosine and distance hardly vary.
const SMALL: f32 = 1e-4;

/// A triangle as seen from a position.
pub struct SphericalTriangle {
    corners: [Vec3; 3],
    position: Vec3,
    /// Unit directions to the corners.
    directions: [Vec3; 3],
    /// Solid angle, steradians; 0 for area sampling.
    solid_angle: f32,
    /// Angle at the first corner.
    alpha: f32,
    /// Vector on the front, twice the area.
    front: Vec3,
}

/// A sampled position of a triangle.
#[derive(Clone, Copy, Debug)]
pub struct TriangleSample {
    /// Unit vector to the sample.
    pub direction: Vec3,
    /// Position on the triangle.
    pub position: Vec3,
    /// Barycentric weights of the second and third corner.
    pub at: Vec2,
    /// Solid angle represented by the sample: the reciprocal of its probability density, steradians.
    pub solid_angle: f32,
}

impl SphericalTriangle {
    /// Prepares a triangle; `None` if it is degenerate as seen from the position.
    pub fn new(corners: [Vec3; 3], position: Vec3) -> Option<Self> {
        let front = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let offsets = corners.map(|corner| corner - position);
        let directions = offsets.map(|offset| offset.try_normalize());
        let [Some(a), Some(b), Some(c)] = directions else { return None };
        // Van Oosterom and Strackee 1983.
        let triple = a.dot(b.cross(c)).abs();
        let solid_angle = 2.0 * triple.arc_tangent2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        let (ab, ac) = (a.cross(b), a.cross(c));
        let alpha = match (ab.try_normalize(), ac.try_normalize()) {
            (Some(ab), Some(ac)) if solid_angle > SMALL => ab.dot(ac).clamp(-1.0, 1.0).arc_cosine(),
            _ => 0.0,
        };
        let solid_angle = if alpha > 0.0 { solid_angle } else { 0.0 };
        let spherical = Self { corners, position, directions: [a, b, c], solid_angle, alpha, front };
        (front != Vec3::ZERO).then_some(spherical)
    }

    /// Samples the triangle with a random `square`, 0 to 1 each; `None` where the triangle is seen edge-on.
    pub fn sample(&self, square: Vec2) -> Option<TriangleSample> {
        if self.solid_angle > 0.0 { self.by_solid_angle(square) } else { self.by_area(square) }
    }

    fn by_area(&self, square: Vec2) -> Option<TriangleSample> {
        let root = square.x.sqrt();
        let at = Vec2::new(root * (1.0 - square.y), root * square.y);
        let [a, b, c] = self.corners;
        let position = a + at.x * (b - a) + at.y * (c - a);
        let offset = position - self.position;
        let distance_squared = offset.length_squared();
        let direction = offset.try_normalize()?;
        // Area times cosine.
        let across = 0.5 * self.front.dot(direction).abs();
        Some(TriangleSample { direction, position, at, solid_angle: across / distance_squared })
    }

    fn by_solid_angle(&self, square: Vec2) -> Option<TriangleSample> {
        let [a, b, c] = self.directions;
        let cos_c = a.dot(b);
        let (sin_alpha, cos_alpha) = self.alpha.sine_cosine();
        // Area of the sub-triangle, by Arvo's formulas.
        let (s, t) = (square.x * self.solid_angle - self.alpha).sine_cosine();
        let (u, v) = (t - cos_alpha, s + sin_alpha * cos_c);
        let below = (v * s + u * t) * sin_alpha;
        let q = ((v * t - u * s) * cos_alpha - v) / below;
        let q = if q.is_finite() { q.clamp(-1.0, 1.0) } else { 1.0 };
        let aside = (c - c.dot(a) * a).normalize_or_zero();
        let third = q * a + (1.0 - q * q).max(0.0).sqrt() * aside;
        let z = 1.0 - square.y * (1.0 - third.dot(b));
        let aside = (third - third.dot(b) * b).normalize_or_zero();
        let direction = (z * b + (1.0 - z * z).max(0.0).sqrt() * aside).try_normalize()?;
        // Intersection with the plane of the triangle.
        let distance = self.front.dot(self.corners[0] - self.position) / self.front.dot(direction);
        let position = self.position + distance * direction;
        let at = self.barycentric(position);
        let is_sound = distance > 0.0 && distance.is_finite() && at.is_finite();
        is_sound.then_some(TriangleSample { direction, position, at, solid_angle: self.solid_angle })
    }

    /// Barycentric weights of the second and third corner, within the triangle.
    fn barycentric(&self, position: Vec3) -> Vec2 {
        let [a, b, c] = self.corners;
        let scale = 1.0 / self.front.length_squared();
        let v = (position - a).cross(c - a).dot(self.front) * scale;
        let w = (b - a).cross(position - a).dot(self.front) * scale;
        let (v, w) = (v.clamp(0.0, 1.0), w.clamp(0.0, 1.0));
        let over = (v + w).max(1.0);
        Vec2::new(v / over, w / over)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    /// Irradiance of a polygon of unit radiance (Lambert's formula).
    fn lambert(corners: &[Vec3], position: Vec3, normal: Vec3) -> f32 {
        let units: Vec<Vec3> = corners.iter().map(|corner| (corner - position).normalize()).collect();
        let edge = |k: usize| {
            let (p, q) = (units[k], units[(k + 1) % units.len()]);
            p.angle_between(q) * normal.dot(p.cross(q).normalize())
        };
        0.5 * (0..units.len()).map(edge).sum::<f32>().abs()
    }

    #[test]
    fn samples_give_the_irradiance_of_lamberts_formula() {
        let mut stream = Stream::new(3, 1);
        for (size, height) in [(1.0, 1.0), (1.0, 0.05), (0.01, 1.0), (0.02, 4.0), (5.0, 0.3)] {
            let corners = [
                Vec3::new(0.1, height, 0.0),
                Vec3::new(0.1 + size, height, 0.2),
                Vec3::new(0.3, height, size),
            ];
            let triangle = SphericalTriangle::new(corners, Vec3::ZERO).unwrap();
            let n = 40_000;
            let mut sum = 0.0;
            for k in 0..n {
                let square = Vec2::new((k as f32 + stream.unit()) / n as f32, stream.unit());
                let Some(sample) = triangle.sample(square) else { continue };
                assert!((sample.position.y - height).abs() < 1e-3 * size.max(height));
                assert!(sample.at.min_element() >= 0.0 && sample.at.element_sum() <= 1.0 + 1e-5);
                sum += f64::from(sample.solid_angle * sample.direction.y / n as f32);
            }
            let expected = f64::from(lambert(&corners, Vec3::ZERO, Vec3::Y));
            assert!((sum / expected - 1.0).abs() < 0.01, "{size} {height}: {sum}, not {expected}");
        }
    }

    #[test]
    fn degenerate_triangles_are_left_out() {
        let line = [Vec3::X, 2.0 * Vec3::X, 3.0 * Vec3::X];
        assert!(SphericalTriangle::new(line, Vec3::ZERO).is_none());
        assert!(SphericalTriangle::new([Vec3::ZERO, Vec3::X, Vec3::Y], Vec3::ZERO).is_none());
    }
}
