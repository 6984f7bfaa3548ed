//! Irradiance from an emissive triangle if nothing were hidden: Lambert's sum in closed form times the mean radiance that
//! the receiver gets from the triangle.
//!
//! A texture's mean depends on the receiver's place, but need not be random: it is taken over fixed points, the same for
//! all receivers. What it is off by is smooth from place to place, and no noise. From afar the points are fixed on the
//! triangle, their radiance is read once; close by they are fixed in the triangle's solid angle.

use super::triangle_sampling::SphericalTriangle;
use crate::geometry::{EmissiveTriangle, Emitters};
use crate::sampling::SurfacePoint;
use glam::{Vec2, Vec3};
use rebounce_shared::light::polygon_projected_solid_angle;
use std::f32::consts::TAU;

/// Fixed points on a triangle that is not evenly bright: the centres of so many times so many equal parts; fewer for
/// receivers that are [`FAR`].
const PARTS: u32 = 8;
const FAR_PARTS: u32 = 4;
/// Rows and columns of fixed directions to a triangle that is close.
const DIRECTIONS: u32 = 8;
/// Square of the distance to a triangle's centre, over its area, above which points on the triangle count.
const NEAR: f32 = 4.0;
/// As [`NEAR`], above which few of them do.
const FAR: f32 = 64.0;

/// A sample of a triangle.
pub struct UnoccludedSample {
    /// Unoccluded radiance times cosine times the solid angle of the triangle, linear RGB.
    pub amount: Vec3,
    /// Cosine times solid angle.
    pub cosine: f32,
    /// Place on the triangle.
    pub position: Vec3,
    /// Unit vector to the place.
    pub direction: Vec3,
}

/// A point on a triangle and the radiance of its front, linear RGB.
#[derive(Clone, Copy)]
struct BrightPoint {
    position: Vec3,
    radiance: Vec3,
}

/// Emissive triangles, prepared.
pub struct Unoccluded<'a> {
    /// The triangles.
    pub emitters: &'a dyn Emitters,
    /// Fixed points of every triangle that is not evenly bright; none for others.
    bright: Vec<Box<[BrightPoint]>>,
}

impl<'a> Unoccluded<'a> {
    /// Reads the radiance of triangles that are not evenly bright.
    pub fn new(emitters: &'a dyn Emitters) -> Self {
        let bright = |number: u32| {
            let emitter = emitters.emitter(number);
            let inwards = -emitter.front().normalize_or_zero();
            let radiance = |weights| emitters.radiance(number, weights, inwards);
            let is_even = super::SAMPLES.iter().all(|weights| {
                let difference = radiance(*weights) - emitter.mean;
                difference.abs().max_element() <= super::EVEN * emitter.mean.max_element()
            });
            let point = |weights: [f32; 3]| {
                let corners = emitter.corners.iter().zip(weights);
                let position = corners.map(|(corner, weight)| weight * *corner).sum();
                BrightPoint { position, radiance: radiance(weights) }
            };
            if is_even {
                return Box::default();
            }
            // The few for far receivers come first.
            centres(FAR_PARTS).chain(centres(PARTS)).map(point).collect()
        };
        Self { emitters, bright: (0..emitters.emitter_count() as u32).map(bright).collect() }
    }

    /// Cost of a triangle's [`Self::irradiance`], in closed forms.
    pub fn cost(&self, number: u32) -> usize {
        if self.bright[number as usize].is_empty() { 1 } else { 8 }
    }

    /// Returns the irradiance from a triangle, linear RGB.
    pub fn irradiance(&self, number: u32, point: &SurfacePoint) -> Vec3 {
        let triangle = self.emitters.emitter(number);
        if !shines_on(&triangle, point) {
            return Vec3::ZERO;
        }
        let form = triangle_irradiance(triangle.corners, point.position, point.normal);
        let bright = &self.bright[number as usize][..];
        if bright.is_empty() || form == 0.0 {
            return triangle.mean * form;
        }
        form * self.mean_radiance(number, &triangle, bright, point).unwrap_or(triangle.mean)
    }

    /// Mean radiance, weighted by the irradiance at a receiver; `None` for zero irradiance.
    fn mean_radiance(
        &self,
        number: u32,
        triangle: &EmissiveTriangle,
        bright: &[BrightPoint],
        point: &SurfacePoint,
    ) -> Option<Vec3> {
        let front = triangle.front();
        let centre = triangle.corners.iter().sum::<Vec3>() / 3.0;
        let far = (centre - point.position).length_squared() / (0.5 * front.length());
        let (mut sum, mut weights) = (Vec3::ZERO, 0.0);
        if far < NEAR {
            let spherical = SphericalTriangle::new(triangle.corners, point.position)?;
            let middle = |k: u32| Vec2::new((k % DIRECTIONS) as f32 + 0.5, (k / DIRECTIONS) as f32 + 0.5);
            let squares = (0..DIRECTIONS * DIRECTIONS).map(|k| middle(k) / DIRECTIONS as f32);
            let samples = squares.filter_map(|square| self.sample(number, &spherical, point, square));
            samples.for_each(|sample| {
                sum += sample.amount;
                weights += sample.cosine;
            });
        } else {
            let (few, many) = bright.split_at((FAR_PARTS * FAR_PARTS) as usize);
            for BrightPoint { position, radiance } in if far < FAR { many } else { few } {
                let offset = *position - point.position;
                let square = offset.length_squared();
                let weight = point.normal.dot(offset).max(0.0) * front.dot(offset).abs() / (square * square);
                sum += weight * *radiance;
                weights += weight;
            }
        }
        (weights > 0.0).then(|| sum / weights)
    }

    /// A sample of a triangle by solid angle, from a place of the unit square; `None` below the receiver's horizon.
    pub fn sample(
        &self,
        number: u32,
        spherical: &SphericalTriangle,
        point: &SurfacePoint,
        square: Vec2,
    ) -> Option<UnoccludedSample> {
        let sample = spherical.sample(square)?;
        let cosine = point.normal.dot(sample.direction) * sample.solid_angle.min(TAU);
        let weights = [1.0 - sample.at.element_sum(), sample.at.x, sample.at.y];
        let radiance = self.emitters.radiance(number, weights, sample.direction);
        let (position, direction) = (sample.position, sample.direction);
        (cosine > 0.0).then_some(UnoccludedSample { amount: radiance * cosine, cosine, position, direction })
    }
}

/// Returns whether a receiver is on a side of a triangle that shines.
pub fn shines_on(triangle: &EmissiveTriangle, point: &SurfacePoint) -> bool {
    triangle.is_two_sided || triangle.front().dot(point.position - triangle.corners[0]) > 0.0
}

/// Irradiance of a place with unit normal from an unoccluded triangle of radiance 1.
fn triangle_irradiance(corners: [Vec3; 3], position: Vec3, normal: Vec3) -> f32 {
    polygon_projected_solid_angle(&corners.map(|corner| corner - position), normal)
}

/// Barycentric weights of the centres of `parts`² equal triangles that a triangle is divided into: their mean is that of
/// any linear function.
fn centres(parts: u32) -> impl Iterator<Item = [f32; 3]> {
    let cells = (0..parts).flat_map(move |x| (0..parts - x).map(move |y| (x, y)));
    let at = move |x: u32, y: u32, third: f32| {
        let [x, y] = [x, y].map(|cell| (cell as f32 + third) / parts as f32);
        [1.0 - x - y, x, y]
    };
    cells.flat_map(move |(x, y)| {
        let mirrored = (x + y + 1 < parts).then(|| at(x, y, 2.0 / 3.0));
        std::iter::once(at(x, y, 1.0 / 3.0)).chain(mirrored)
    })
}

/// Point number k of the additive recurrence of Roberts (2018), in the unit square.
pub fn low_discrepancy(k: u32) -> Vec2 {
    (Vec2::splat(0.5) + k as f32 * Vec2::new(0.754_877_7, 0.569_840_3)).fract()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::PI;

    #[test]
    fn triangles_give_the_irradiance_of_their_form_factor() {
        let square = |half: f32, height: f32| {
            let [a, b, c, d] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[x, z]: [f32; 2]| Vec3::new(half * x, height, half * z));
            [[a, b, c], [a, c, d]]
        };
        let from = |triangles: [[Vec3; 3]; 2], normal| {
            triangles.iter().map(|corners| triangle_irradiance(*corners, Vec3::ZERO, normal)).sum::<f32>()
        };
        // A square overhead (Howell, catalogue of configuration factors, B-4, four times).
        let x = 0.5f32 / (1.0 + 0.25f32).sqrt();
        let expected = 4.0 * 0.5 * (2.0 * x * x.atan());
        assert!((from(square(0.5, 1.0), Vec3::Y) - expected).abs() < 1e-5);
        // One that covers the sky, and half of it over a tilted horizon.
        assert!((from(square(1e4, 1.0), Vec3::Y) / PI - 1.0).abs() < 1e-3);
        assert!((from(square(1e4, 1.0), Vec3::X) / PI - 0.5).abs() < 1e-3);
        assert_eq!(from(square(1.0, 1.0), Vec3::NEG_Y), 0.0);
    }

    /// A triangle that faces down, red along x and green along z.
    struct Gradient;

    impl Emitters for Gradient {
        fn emitter_count(&self) -> usize {
            1
        }

        fn emitter(&self, _: u32) -> EmissiveTriangle {
            EmissiveTriangle {
                corners: [Vec3::ZERO, Vec3::X, Vec3::Z],
                is_two_sided: false,
                material: 0,
                mean: Vec3::new(1.0, 1.0, 0.0) / 3.0,
            }
        }

        fn radiance(&self, _: u32, [_, x, z]: [f32; 3], _: Vec3) -> Vec3 {
            Vec3::new(x, z, 0.0)
        }
    }

    #[test]
    fn fixed_points_give_a_textures_irradiance_at_any_distance() {
        let unoccluded = Unoccluded::new(&Gradient);
        for height in [0.05f32, 0.3, 0.9, 1.5, 4.0, 20.0] {
            let position = Vec3::new(0.5, -height, 0.2);
            let point = SurfacePoint { position, normal: Vec3::Y, geometric_normal: Vec3::Y, group: 0 };
            let spherical = SphericalTriangle::new(Gradient.emitter(0).corners, position).unwrap();
            let count = 1 << 16;
            let samples = (0..count)
                .filter_map(|k| unoccluded.sample(0, &spherical, &point, low_discrepancy(k)))
                .map(|sample| sample.amount);
            let truth = samples.sum::<Vec3>() / count as f32;
            let found = unoccluded.irradiance(0, &point);
            let error = (found - truth).abs().max_element() / truth.max_element();
            assert!(error < 0.02, "{height}: {found}, {truth}");
        }
    }
}
