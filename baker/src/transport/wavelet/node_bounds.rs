//! Bounds of a cell of an emitter, or of several patches: a box around positions, and a cone around normals.
//!
//! The cosine at an emitter is bounded by box and cone, that at the receiver by the box (Walter et al. 2005,
//! Lightcuts, 4.1). Slivers side by side, as those of a cylinder, have much smaller boxes than balls.

use super::patch::PatchPoint;
use glam::DVec3;
use rebounce_shared::elementary::Elementary;
use std::f64::consts::FRAC_PI_2;

/// Bounds of positions and normals.
#[derive(Clone, Copy, Debug)]
pub(super) struct NodeBounds {
    low: DVec3,
    high: DVec3,
    /// `None`: normals may have any direction.
    cone: Option<NormalCone>,
}

/// Unit vectors within an angle, less than a right one, about an axis.
#[derive(Clone, Copy, Debug)]
struct NormalCone {
    axis: DVec3,
    /// Radians.
    angle: f64,
}

/// The cosines of a node and a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Facing {
    /// One of the two is 0 everywhere: no light gets there.
    Never,
    /// Both are above 0 for some or all of the node.
    Maybe {
        /// Upper bound of their product.
        most: f64,
        /// Both are above 0 everywhere.
        is_everywhere: bool,
    },
}

impl NodeBounds {
    /// A planar quadrilateral.
    pub(super) fn planar(corners: &[DVec3; 4], normal: DVec3) -> Self {
        let limit = |of: fn(DVec3, DVec3) -> DVec3| corners.iter().copied().fold(corners[0], of);
        let cone = Some(NormalCone { axis: normal, angle: 0.0 });
        Self { low: limit(DVec3::min), high: limit(DVec3::max), cone }
    }

    /// A ball, with normals of any direction.
    pub(super) fn ball((centre, radius): (DVec3, f64)) -> Self {
        Self { low: centre - radius, high: centre + radius, cone: None }
    }

    /// Both.
    pub(super) fn union(self, other: Self) -> Self {
        let cone = match (self.cone, other.cone) {
            (Some(a), Some(b)) => a.union(b),
            _ => None,
        };
        Self { low: self.low.min(other.low), high: self.high.max(other.high), cone }
    }

    /// Distance of a point; 0 inside of the box.
    pub(super) fn distance(&self, position: DVec3) -> f64 {
        position.distance(position.clamp(self.low, self.high))
    }

    /// Bounds of both cosines.
    pub(super) fn facing(&self, receiver: &PatchPoint) -> Facing {
        let half = 0.5 * (self.high - self.low);
        let from = 0.5 * (self.high + self.low) - receiver.position;
        // Of dot products with what lies in the box, seen from the receiver.
        let range = |direction: DVec3| {
            let (middle, reach) = (from.dot(direction), half.dot(direction.abs()));
            [middle - reach, middle + reach]
        };
        let [lowest, highest] = range(receiver.normal);
        if highest <= 0.0 {
            return Facing::Never;
        }
        let nearest = self.distance(receiver.position);
        let cosine = |along: f64| if along < nearest { along / nearest } else { 1.0 };
        let mut most = cosine(highest);
        let Some(NormalCone { axis, angle }) = self.cone else {
            return Facing::Maybe { most, is_everywhere: false };
        };
        let farthest = from.length() + half.length();
        let (sine, cosine_of_angle) = angle.sine_cosine();
        let [low, high] = range(-axis);
        let sideways = farthest * sine;
        let towards = if high > 0.0 { high } else { high * cosine_of_angle } + sideways;
        if towards <= 0.0 {
            return Facing::Never;
        }
        most *= cosine(towards);
        Facing::Maybe { most, is_everywhere: lowest > 0.0 && low * cosine_of_angle > sideways }
    }
}

impl NormalCone {
    /// A cone around both; `None` if that is not less than a half-space.
    fn union(self, other: Self) -> Option<Self> {
        let axis = (self.axis + other.axis).try_normalize()?;
        let reach = |cone: Self| {
            let between = 2.0 * (cone.axis - axis).length().arc_tangent2((cone.axis + axis).length());
            between + cone.angle
        };
        let angle = reach(self).max(reach(other));
        (angle < FRAC_PI_2).then_some(Self { axis, angle })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rebounce_shared::random::Stream;

    fn unit(stream: &mut Stream) -> DVec3 {
        let mut at = || f64::from(stream.unit()) - 0.5;
        DVec3::new(at(), at(), at()).normalize()
    }

    /// Random small squares, as corners and normal, and the bounds of their union.
    fn squares(stream: &mut Stream, spread: f64) -> (Vec<[DVec3; 5]>, NodeBounds) {
        let about = unit(stream);
        let square = |_| {
            let normal = (about + spread * unit(stream)).normalize();
            let middle = unit(stream) * DVec3::new(1.0, 0.1, 0.3);
            let (a, b) = normal.any_orthonormal_pair();
            let corners = [-a - b, a - b, a + b, b - a].map(|corner| middle + 0.05 * corner);
            [corners[0], corners[1], corners[2], corners[3], normal]
        };
        let squares: Vec<[DVec3; 5]> = (0..5).map(square).collect();
        let of = |[a, b, c, d, normal]: &[DVec3; 5]| NodeBounds::planar(&[*a, *b, *c, *d], *normal);
        let all = squares.iter().map(of).reduce(NodeBounds::union).unwrap();
        (squares, all)
    }

    #[test]
    fn no_cosine_is_above_the_bound_or_of_another_sign() {
        let mut stream = Stream::new(5, 0);
        let mut counts = [0; 3];
        for round in 0..20_000 {
            let spread = [0.0, 0.1, 0.5, 2.0][round % 4];
            let (squares, bounds) = squares(&mut stream, spread);
            let [position, normal] = [6.0 * f64::from(stream.unit()) * unit(&mut stream), unit(&mut stream)];
            let receiver = PatchPoint { position, normal, seen_from: position, seen_normal: normal };
            let facing = bounds.facing(&receiver);
            counts[match facing {
                Facing::Never => 0,
                Facing::Maybe { is_everywhere: false, .. } => 1,
                Facing::Maybe { is_everywhere: true, .. } => 2,
            }] += 1;
            for square in &squares {
                let weights = [0, 1, 2, 3].map(|_| f64::from(stream.unit()));
                let sum: f64 = weights.iter().sum();
                let at: DVec3 = (0..4).map(|i| weights[i] / sum * square[i]).sum();
                let between = at - position;
                assert!(between.length() >= bounds.distance(position) - 1e-12);
                let direction = between.normalize();
                let cosines = [direction.dot(normal), -direction.dot(square[4])];
                match facing {
                    Facing::Never => assert!(cosines[0].min(cosines[1]) <= 1e-12),
                    Facing::Maybe { most, is_everywhere } => {
                        let product = cosines.map(|it| it.max(0.0)).iter().product::<f64>();
                        assert!(product <= most + 1e-12, "{product} {most}");
                        assert!(!is_everywhere || cosines[0].min(cosines[1]) > 0.0);
                    }
                }
            }
        }
        assert!(counts.iter().all(|count| *count > 1000), "{counts:?}");
    }
}
