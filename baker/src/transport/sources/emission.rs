//! Irradiance from the groups of emissive surfaces at a receiver: next-event estimation over the emissive triangles, by
//! solid angle, with visibility rays.
//!
//! A ratio estimator (Heitz, Hill and McGuire 2018, "Combining analytic direct illumination and stochastic shadows"): the
//! unoccluded irradiance has a closed form, and the visibility rays estimate the share that arrives, the *visibility*.
//! Unoccluded emitters have no noise, whatever their texture; hidden emitters have no irradiance.
//! Elsewhere the noise is that of the visibility alone: [`GroupSeen::towards`] judges it by the parents' visibility.

use super::emitter_tree::{Assigned, EmitterTree};
use super::group_seen::{GroupSeen, Pairs, as_visible_as, by_ratio};
use super::triangle_sampling::SphericalTriangle;
use super::unoccluded::{Unoccluded, low_discrepancy, shines_on};
use crate::geometry::{Emitters, Surfaces};
use crate::random::{Stream, mix};
use crate::sampling::SurfacePoint;
use glam::{Vec2, Vec3};
use smallvec::SmallVec;

/// Share of the distance to a sample that its visibility ray leaves out, so that the emitter does not hide itself.
const SHORTER: f32 = 1e-3;
/// Least number of visibility rays to a group.
const LEAST: u32 = 8;
/// Expected number of samples from which on a triangle has a ratio of its own; the others of a group share one.
const OWN: f32 = 2.0;
/// Greatest cost of a group whose unoccluded irradiance is summed in closed form at each receiver.
const MOST_SUMMED: usize = 512;
/// Rays to a group whose first estimate is too noisy, over those of the first.
const MORE: u32 = 8;

/// Emissive triangles with their groups.
pub struct Emission<'a> {
    unoccluded: Unoccluded<'a>,
    /// A tree a group, so that each is estimated as well as the others, however bright: a mixer may leave it alone.
    trees: Vec<EmitterTree>,
    /// Emitters of each group; none where they are too many to be summed in closed form.
    summed: Vec<Vec<u32>>,
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
        let unoccluded = Unoccluded::new(emitters);
        for numbers in &mut numbers {
            if numbers.iter().map(|number| unoccluded.cost(*number)).sum::<usize>() > MOST_SUMMED {
                numbers.clear();
            }
        }
        Self { trees, summed: numbers, unoccluded }
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
        let mut stream = Stream::new(mix(seed) ^ 0x656d_6974, receiver as u64);
        let samples = self.rays_a_group(rays);
        let groups = 0..self.trees.len();
        groups
            .zip(out)
            .map(|(group, found)| {
                let (seen, rays) = self.see_group(surfaces, point, group, samples, &mut stream, assigned);
                *found = seen;
                rays
            })
            .sum()
    }

    /// Estimates groups anew, with [`MORE`] times as many rays, whose estimates are noisier than their tolerances, judged
    /// by the `parents'` visibility of each group; returns the number of rays.
    #[expect(
        clippy::too_many_arguments,
        reason = "a receiver, what is known of it, and where the result goes"
    )]
    pub fn look_again<S: Surfaces + ?Sized>(
        &self,
        surfaces: &S,
        (point, receiver): (&SurfacePoint, usize),
        rays: u32,
        seed: u64,
        parents: &[Vec3],
        tolerances: &[Vec3],
        assigned: &mut Vec<Assigned>,
        out: &mut [GroupSeen],
    ) -> u64 {
        let mut stream = Stream::new(mix(seed) ^ 0x616e_6577, receiver as u64);
        let samples = MORE * self.rays_a_group(rays);
        let mut rays = 0;
        for (group, found) in out.iter_mut().enumerate() {
            if found.is_noisy(parents[group], tolerances[group]) {
                let (again, cast) = self.see_group(surfaces, point, group, samples, &mut stream, assigned);
                *found = if found.spread.is_finite() { found.with(again, MORE as f32) } else { again };
                rays += cast;
            }
        }
        rays
    }

    /// Estimates the irradiance of a receiver from one group; returns the number of rays, too.
    fn see_group<S: Surfaces + ?Sized>(
        &self,
        surfaces: &S,
        point: &SurfacePoint,
        group: usize,
        samples: u32,
        stream: &mut Stream,
        assigned: &mut Vec<Assigned>,
    ) -> (GroupSeen, u64) {
        let (tree, summed) = (&self.trees[group], &self.summed[group]);
        let origin = point.position + point.geometric_normal * surfaces.epsilon_at(point.position);
        let (mut found, mut rays) = (GroupSeen::default(), 0);
        tree.assign(point.position, point.normal, samples, stream, assigned);
        // Samples of triangles that have few each.
        let mut scattered = Pairs::new();
        for assigned in assigned.iter() {
            rays += self.add(surfaces, point, origin, assigned, stream, &mut found, &mut scattered);
        }
        if summed.is_empty() {
            let [all, squares] = scattered
                .iter()
                .fold([Vec3::ZERO; 2], |[all, squares], pair| [all + pair.0, squares + pair.0 * pair.0]);
            // Variance of a sum of independent samples.
            let spread = squares - all * all / scattered.len().max(1) as f32;
            found.add(GroupSeen { variance: spread.max(Vec3::ZERO), ..by_ratio(all, &scattered) });
            return (found, rays);
        }
        let own = assigned.iter().filter(|assigned| assigned.expected >= OWN);
        let own: SmallVec<[u32; 32]> = own.map(|assigned| assigned.emitter).collect();
        let whole = summed.iter().filter(|number| !own.contains(number));
        let whole = whole.map(|number| self.unoccluded.irradiance(*number, point)).sum();
        if scattered.is_empty() {
            found.add(as_visible_as(&found, whole));
        } else {
            found.add(by_ratio(whole, &scattered));
        }
        (found, rays)
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
        let triangle = self.unoccluded.emitters.emitter(emitter);
        if !shines_on(&triangle, point) {
            return 0;
        }
        let Some(spherical) = SphericalTriangle::new(triangle.corners, point.position) else { return 0 };
        let mut rays = 0;
        let shift = Vec2::new(stream.unit(), stream.unit());
        let mut pairs = Pairs::new();
        for k in 0..samples {
            // Well spread over the triangle, and shifted from receiver to receiver.
            let square = (low_discrepancy(k) + shift).fract();
            let Some(sample) = self.unoccluded.sample(emitter, &spherical, point, square) else { continue };
            let is_above = point.geometric_normal.dot(sample.direction) > 0.0;
            rays += u64::from(is_above);
            let end = sample.position.lerp(origin, SHORTER);
            let through = if is_above { surfaces.transmittance(origin, end) } else { Vec3::ZERO };
            pairs.push((sample.amount, sample.amount * through));
        }
        if expected < OWN {
            scattered.extend(pairs.iter().map(|pair| (pair.0 / expected, pair.1 / expected)));
            return rays;
        }
        found.add(by_ratio(self.unoccluded.irradiance(emitter, point), &pairs));
        rays
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::EmissiveTriangle;
    use crate::geometry::mesh::TriangleSurfaces;

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
            let point = SurfacePoint { position, normal, geometric_normal: normal, group: 0 };
            emission.see(&room, (&point, k), 16, 1, &mut assigned, &mut out);
            let exact: Vec3 = (0..64).map(|number| emission.unoccluded.irradiance(number, &point)).sum();
            let [GroupSeen { irradiance, variance, .. }] = out;
            assert!((irradiance - exact).abs().max_element() < 1e-4 * exact.max_element(), "{irradiance}");
            assert!(exact.min_element() > 0.1 && variance.max_element() < 1e-6, "{exact}, {variance}");
        }
    }
}
