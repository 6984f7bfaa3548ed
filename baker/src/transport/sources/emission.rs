//! Irradiance from the groups of emissive surfaces at a receiver: next-event estimation over the emissive triangles, by
//! solid angle, with visibility rays.
//!
//! A ratio estimator (Heitz, Hill and McGuire 2018, "Combining analytic direct illumination and stochastic shadows"): the
//! unoccluded irradiance has a closed form, and the visibility rays estimate the share that arrives. Where nothing is
//! hidden there is no noise, whatever the emission's texture; where all is, the irradiance is 0.

use super::emitter_tree::{Assigned, EmitterTree};
use super::triangle_sampling::SphericalTriangle;
use crate::geometry::{EmissiveTriangle, Emitters, Surfaces};
use crate::random::{Stream, mix};
use crate::sampling::SurfacePoint;
use glam::{Vec2, Vec3};
use rebounce_shared::light::polygon_projected_solid_angle;
use smallvec::SmallVec;
use std::f32::consts::TAU;

/// Share of the distance to a sample that its visibility ray leaves out, so that the emitter does not hide itself.
const SHORTER: f32 = 1e-3;
/// Least number of visibility rays to a group.
const LEAST: u32 = 8;
/// Expected number of samples from which on a triangle has a ratio of its own; the others of a group share one.
const OWN: f32 = 2.0;
/// Greatest number of triangles of a group whose unoccluded irradiance is summed in closed form at each receiver.
const MOST_SUMMED: usize = 512;
/// Fixed points for the mean radiance of a triangle that is not evenly bright, for each visibility ray.
const FIXED: u32 = 8;

/// Irradiance from one group, linear RGB, and the variance of its estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GroupSeen {
    /// Irradiance.
    pub irradiance: Vec3,
    /// Variance of the irradiance, estimated from the samples.
    pub variance: Vec3,
}

/// Emissive triangles with their groups.
pub struct Emission<'a> {
    emitters: &'a dyn Emitters,
    /// A tree a group, so that each is estimated as well as the others, however bright: a mixer may leave it alone.
    trees: Vec<EmitterTree>,
    /// Emitters of each group; none where they are too many, or not all evenly bright, to be summed in closed form.
    summed: Vec<Vec<u32>>,
    /// Whether each emitter is evenly bright.
    is_even: Vec<bool>,
}

/// Samples of an estimate: irradiance without visibility, and with it.
type Pairs = SmallVec<[(Vec3, Vec3); 32]>;

/// Returns the irradiance and its variance by the ratio estimator: the unoccluded irradiance times the share of the samples
/// that arrives.
fn by_ratio(whole: Vec3, pairs: &[(Vec3, Vec3)]) -> GroupSeen {
    let [all, through] = pairs.iter().fold([Vec3::ZERO; 2], |[a, t], pair| [a + pair.0, t + pair.1]);
    // A channel that no sample found has the visibility of the others.
    let mean = through.element_sum() / all.element_sum().max(f32::MIN_POSITIVE);
    let ratio = Vec3::select(all.cmpgt(Vec3::ZERO), through / all, Vec3::splat(mean));
    let residual = |(amount, through): &(Vec3, Vec3)| *through - ratio * *amount;
    let residuals: Vec3 = pairs.iter().map(|pair| residual(pair) * residual(pair)).sum();
    let scale = Vec3::select(all.cmpgt(Vec3::ZERO), whole / all, Vec3::ZERO);
    GroupSeen { irradiance: whole * ratio, variance: residuals * scale * scale }
}

impl GroupSeen {
    fn add(&mut self, other: Self) {
        self.irradiance += other.irradiance;
        self.variance += other.variance;
    }
}

impl<'a> Emission<'a> {
    /// Prepares emitters of `groups` groups; `group_of` has the group of each material, `None` without emission.
    pub fn new(emitters: &'a dyn Emitters, group_of: &[Option<u32>], groups: usize) -> Self {
        let mut numbers = vec![Vec::new(); groups];
        for number in 0..emitters.emitter_count() as u32 {
            let group = group_of.get(emitters.emitter(number).material as usize).copied().flatten();
            if let Some(numbers) = group.and_then(|group| numbers.get_mut(group as usize)) {
                numbers.push(number);
            }
        }
        let trees = numbers.iter().map(|numbers| EmitterTree::new(emitters, numbers.iter().copied()));
        let trees = trees.collect();
        let is_even = |number: u32| {
            let emitter = emitters.emitter(number);
            let inwards = -emitter.front().normalize_or_zero();
            super::SAMPLES.iter().all(|weights| {
                let difference = emitters.radiance(number, *weights, inwards) - emitter.mean;
                difference.abs().max_element() <= super::EVEN * emitter.mean.max_element()
            })
        };
        let is_even: Vec<bool> = (0..emitters.emitter_count() as u32).map(is_even).collect();
        for numbers in &mut numbers {
            if numbers.len() > MOST_SUMMED || !numbers.iter().all(|number| is_even[*number as usize]) {
                numbers.clear();
            }
        }
        Self { emitters, trees, summed: numbers, is_even }
    }

    /// Visibility rays to each group, for `rays` per receiver: at least [`LEAST`] as long as all together are at most four
    /// times as many.
    pub fn rays_a_group(&self, rays: u32) -> u32 {
        let groups = self.trees.len().max(1) as u32;
        (rays / groups).max(LEAST.min(4 * rays / groups)).max(1)
    }

    /// Estimates the irradiance of a receiver from each group, with about `rays` visibility rays in all; returns their
    /// number.
    pub fn see<S: Surfaces + ?Sized>(
        &self,
        surfaces: &S,
        (point, receiver): (&SurfacePoint, usize),
        rays: u32,
        seed: u64,
        assigned: &mut Vec<Assigned>,
        out: &mut [GroupSeen],
    ) -> u64 {
        out.fill(GroupSeen::default());
        let mut stream = Stream::new(mix(seed) ^ 0x656d_6974, receiver as u64);
        let origin = point.position + point.geometric_normal * surfaces.epsilon_at(point.position);
        let samples = self.rays_a_group(rays);
        let mut rays = 0;
        for ((tree, summed), found) in self.trees.iter().zip(&self.summed).zip(out) {
            tree.assign(point.position, point.normal, samples, &mut stream, assigned);
            // Samples of triangles that have few each.
            let mut scattered = Pairs::new();
            for assigned in assigned.iter() {
                rays += self.add(surfaces, point, origin, assigned, &mut stream, found, &mut scattered);
            }
            if summed.is_empty() || scattered.is_empty() {
                let irradiance = scattered.iter().map(|pair| pair.1).sum();
                // Variance of a sum of independent samples.
                let squares: Vec3 = scattered.iter().map(|pair| pair.1 * pair.1).sum();
                let spread = squares - irradiance * irradiance / scattered.len().max(1) as f32;
                found.add(GroupSeen { irradiance, variance: spread.max(Vec3::ZERO) });
                continue;
            }
            let own = assigned.iter().filter(|assigned| assigned.expected >= OWN);
            let own: SmallVec<[u32; 32]> = own.map(|assigned| assigned.emitter).collect();
            let whole = summed.iter().filter(|number| !own.contains(number));
            let whole = whole.map(|number| self.unoccluded(*number, point)).sum();
            found.add(by_ratio(whole, &scattered));
        }
        rays
    }

    /// Returns whether a receiver is on a side of a triangle that shines.
    fn shines_on(&self, triangle: &EmissiveTriangle, point: &SurfacePoint) -> bool {
        triangle.is_two_sided || triangle.front().dot(point.position - triangle.corners[0]) > 0.0
    }

    /// Returns the unoccluded irradiance from an evenly bright triangle.
    fn unoccluded(&self, number: u32, point: &SurfacePoint) -> Vec3 {
        let triangle = self.emitters.emitter(number);
        if !self.shines_on(&triangle, point) {
            return Vec3::ZERO;
        }
        triangle.mean * triangle_irradiance(triangle.corners, point.position, point.normal)
    }

    /// Adds the irradiance from a triangle to `found`, or where it has few samples, these to `scattered`; returns the
    /// number of rays.
    #[expect(clippy::too_many_arguments, reason = "a receiver, a triangle, and where the result goes")]
    fn add<S: Surfaces + ?Sized>(
        &self,
        surfaces: &S,
        point: &SurfacePoint,
        origin: Vec3,
        &Assigned { emitter, samples, expected }: &Assigned,
        stream: &mut Stream,
        found: &mut GroupSeen,
        scattered: &mut Pairs,
    ) -> u64 {
        let triangle = self.emitters.emitter(emitter);
        if !self.shines_on(&triangle, point) {
            return 0;
        }
        let Some(spherical) = SphericalTriangle::new(triangle.corners, point.position) else { return 0 };
        // Amount and cosine without visibility, and the sample.
        let unoccluded = |square: Vec2| {
            let sample = spherical.sample(square)?;
            let cosine = point.normal.dot(sample.direction) * sample.solid_angle.min(TAU);
            let weights = [1.0 - sample.at.element_sum(), sample.at.x, sample.at.y];
            let radiance = self.emitters.radiance(emitter, weights, sample.direction);
            (cosine > 0.0).then_some((radiance * cosine, cosine, sample))
        };
        let (mut rays, turn) = (0, stream.unit());
        let mut pairs = Pairs::new();
        for k in 0..samples {
            // The first coordinate is stratified over the triangle's samples.
            let square =
                Vec2::new((k as f32 + stream.unit()) / samples as f32, (turn + stream.unit()).fract());
            let Some((amount, _, sample)) = unoccluded(square) else { continue };
            let is_above = point.geometric_normal.dot(sample.direction) > 0.0;
            rays += u64::from(is_above);
            let end = sample.position.lerp(origin, SHORTER);
            let through = if is_above { surfaces.transmittance(origin, end) } else { Vec3::ZERO };
            pairs.push((amount, amount * through));
        }
        if expected < OWN {
            scattered.extend(pairs.iter().map(|pair| (pair.0 / expected, pair.1 / expected)));
            return rays;
        }
        let radiance = match self.is_even[emitter as usize] {
            true => triangle.mean,
            // Mean radiance by the cosine.
            false => {
                let count = FIXED * (expected.ceil() as u32).next_power_of_two();
                let fixed = (0..count).filter_map(|k| unoccluded(low_discrepancy(k)));
                let sums = fixed
                    .fold((Vec3::ZERO, 0.0), |sums, (amount, cosine, _)| (sums.0 + amount, sums.1 + cosine));
                sums.0 / sums.1.max(f32::MIN_POSITIVE)
            }
        };
        let whole = radiance * triangle_irradiance(triangle.corners, point.position, point.normal);
        found.add(by_ratio(whole, &pairs));
        rays
    }
}

/// Irradiance of a place with unit normal from an unoccluded triangle of radiance 1.
fn triangle_irradiance(corners: [Vec3; 3], position: Vec3, normal: Vec3) -> f32 {
    polygon_projected_solid_angle(&corners.map(|corner| corner - position), normal)
}

/// Point number k of the additive recurrence of Roberts (2018), in the unit square. The same for all receivers: what it
/// is off by is smooth from place to place, and no noise.
fn low_discrepancy(k: u32) -> Vec2 {
    (Vec2::splat(0.5) + k as f32 * Vec2::new(0.754_877_7, 0.569_840_3)).fract()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::mesh::TriangleSurfaces;
    use std::f32::consts::PI;

    /// Tiles of many colours on a ceiling, facing down.
    struct Tiles(Vec<EmissiveTriangle>);

    impl Tiles {
        fn new() -> Self {
            let tile = |k: u32| {
                let at = Vec3::new(-0.8 + 0.2 * (k % 8) as f32, 0.9, -0.8 + 0.2 * (k / 8) as f32);
                EmissiveTriangle {
                    corners: [at, at + 0.2 * Vec3::X, at + 0.2 * Vec3::Z],
                    is_two_sided: false,
                    material: 0,
                    mean: Vec3::new((k % 3) as f32, (k % 5) as f32, (k % 7) as f32),
                }
            };
            Self((0..64).map(tile).collect())
        }
    }

    impl Emitters for Tiles {
        fn emitter_count(&self) -> usize {
            self.0.len()
        }

        fn emitter(&self, number: u32) -> EmissiveTriangle {
            self.0[number as usize]
        }

        fn radiance(&self, number: u32, _weights: [f32; 3], direction: Vec3) -> Vec3 {
            self.0[number as usize].mean * f32::from(self.0[number as usize].front().dot(direction) < 0.0)
        }
    }

    #[test]
    fn a_mosaic_that_nothing_hides_has_no_noise() {
        let room = TriangleSurfaces::from_scene(&crate::io::load("builtin:furnace").unwrap());
        let tiles = Tiles::new();
        let emission = Emission::new(&tiles, &[Some(0)], 1);
        let (mut assigned, mut out) = (Vec::new(), [GroupSeen::default()]);
        for k in 0..50 {
            let position = Vec3::new(-0.9 + 0.036 * k as f32, -0.95, 0.3);
            let normal = Vec3::new(0.01 * k as f32, 1.0, 0.0).normalize();
            let point = SurfacePoint { position, normal, geometric_normal: normal };
            emission.see(&room, (&point, k), 16, 1, &mut assigned, &mut out);
            let exact: Vec3 = (0..64).map(|number| emission.unoccluded(number, &point)).sum();
            let [GroupSeen { irradiance, variance }] = out;
            assert!((irradiance - exact).abs().max_element() < 1e-4 * exact.max_element(), "{irradiance}");
            assert!(exact.min_element() > 0.1 && variance.max_element() < 1e-6, "{exact}, {variance}");
        }
    }

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
}
