//! Quadrature of the senders: ten places on each sender's surface that stand for equal parts of the area under its
//! function, A_j = ∫ B_j dA. A link is the mean of its kernel over them (Lehtinen et al. 2007, 6.5).

use super::children::Children;
use crate::basis::{Evaluator, SENDER_OVERLAP};
use crate::geometry::{Ray, Surfaces};
use crate::job::watch::{Stopped, Watch};
use crate::random::{Stream, mix};
use crate::sampling::Points;
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use rebounce_shared::elementary::Elementary;
use rebounce_shared::kernel::{LEAST_COSINE, LEAST_WEIGHT};

/// Places of a sender, and rays of a link.
pub const PLACES: usize = 10;
/// Candidates that the places are chosen from: on the finest sender level, and at most.
const CANDIDATES: [usize; 2] = [32, 128];
/// Height of the candidates' rays above the surface, in support radii.
const ABOVE: f32 = 0.1;

/// Distance from which places resolve the kernel, in roots of the area that a place stands for.
const NEAR: f32 = 2.0;

/// A place on a sender.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SenderSample {
    /// Position, moved off the surface, local space.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// Linear RGB reflectance.
    pub albedo: Vec3,
    /// Whether a function of the next finer sender level covers the place: a refined sender hands the place on.
    pub is_handed_on: bool,
}

/// Places of all senders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Quadrature {
    /// Area under each sender's function, square scene units; 0 for a sender without places.
    areas: Vec<f32>,
    /// [`PLACES`] places for each sender with an area.
    places: Vec<[SenderSample; PLACES]>,
    /// Positions and normals of each sender's places by axis, and their light in the sender's tint.
    lanes: Vec<[[f32; PLACES]; 7]>,
    /// Functions that cover each sender's places on the finest coarser level, with their mean weights.
    parents: Vec<Vec<(u32, f32)>>,
}

impl Quadrature {
    /// Finds the places of the senders on the levels of `evaluators`, coarsest first; `duals` are the
    /// [duals](super::super::tint::duals) of their tints. A unit of `watch` is a sender.
    ///
    /// # Errors
    /// [`Stopped`].
    pub fn new<S: Surfaces + ?Sized>(
        surfaces: &S,
        points: &Points,
        evaluators: &[Evaluator],
        duals: &[Vec3A],
        watch: &dyn Watch,
    ) -> Result<Self, Stopped> {
        let mut all = Self::default();
        watch.expect(points.count_on(evaluators.len()) as u64);
        for (level, evaluator) in evaluators.iter().enumerate() {
            let finer = &evaluators[level + 1..];
            let count = (CANDIDATES[0] << (2 * finer.len()).min(16)).min(CANDIDATES[1]);
            let found = points.levels[level].range().into_par_iter().map(|sender| {
                watch.step(1)?;
                let (area, places) =
                    SampleFinder { surfaces, points, evaluator, finer, level }.places(sender, count);
                let parents = if area > 0.0 {
                    parents(&places, points.points[sender].group, &evaluators[..level])
                } else {
                    Vec::new()
                };
                Ok((area, places, parents))
            });
            for (area, places, parents) in found.collect::<Result<Vec<_>, Stopped>>()? {
                let dual = duals[all.areas.len()];
                all.lanes.push([
                    places.map(|place| place.position.x),
                    places.map(|place| place.position.y),
                    places.map(|place| place.position.z),
                    places.map(|place| place.normal.x),
                    places.map(|place| place.normal.y),
                    places.map(|place| place.normal.z),
                    places.map(|place| Vec3A::from(place.albedo).dot(dual)),
                ]);
                all.areas.push(area);
                all.places.push(places);
                all.parents.push(parents);
            }
        }
        Ok(all)
    }

    /// Area under a sender's function, square scene units.
    #[inline]
    pub fn area(&self, sender: usize) -> f32 {
        self.areas[sender]
    }

    /// Places of a sender; they mean nothing where the area is 0.
    #[inline]
    pub fn places(&self, sender: usize) -> &[SenderSample; PLACES] {
        &self.places[sender]
    }

    /// Places of a sender side by side: positions and normals by axis, and light in the sender's tint.
    #[inline]
    pub fn lanes(&self, sender: usize) -> &[[f32; PLACES]; 7] {
        &self.lanes[sender]
    }

    /// Squared distance within which the places of a sender are too far apart for the kernel, square scene units.
    #[inline]
    pub fn near_squared(&self, sender: usize) -> f32 {
        NEAR * NEAR * self.areas[sender] / PLACES as f32
    }

    /// Squared distance from a place within which the sender may have a near part, square scene units.
    #[inline]
    pub fn reach(&self, sender: usize) -> f32 {
        // The disk of the area, across, beyond the near field.
        let across = 2.0 * (self.areas[sender] / std::f32::consts::PI).sqrt();
        (self.near_squared(sender).sqrt() + across).powi(2)
    }

    /// Children of every sender.
    pub fn children(&self) -> Children {
        Children::transposed(self.count(), |child| self.parents[child].iter().copied())
    }

    /// Number of senders.
    pub fn count(&self) -> usize {
        self.areas.len()
    }
}

/// Functions that cover places on the finest of these levels that does, with their mean weights over the places that are
/// covered, ascending.
fn parents(places: &[SenderSample; PLACES], group: u32, coarser: &[Evaluator]) -> Vec<(u32, f32)> {
    let mut found: Vec<(u32, f32)> = Vec::new();
    for place in places {
        let mut here: Vec<(u32, f32)> = Vec::new();
        for level in coarser.iter().rev() {
            here.clear();
            let total = level.gather(place.position, place.normal, group, |i, weight| here.push((i, weight)));
            if total > LEAST_WEIGHT {
                found.extend(here.iter().map(|(i, weight)| (*i, weight / total)));
                break;
            }
        }
    }
    // Stable: weights are summed in the order of the places.
    found.sort_by_key(|parent| parent.0);
    found.dedup_by(|other, kept| {
        let is_same = other.0 == kept.0;
        kept.1 += if is_same { other.1 } else { 0.0 };
        is_same
    });
    let total: f32 = found.iter().map(|parent| parent.1).sum();
    found.iter_mut().for_each(|parent| parent.1 /= total);
    found
}

/// Finds the places of senders of a level.
struct SampleFinder<'a, S: ?Sized> {
    surfaces: &'a S,
    points: &'a Points,
    evaluator: &'a Evaluator,
    /// Evaluators of the finer sender levels, coarsest first.
    finer: &'a [Evaluator],
    level: usize,
}

impl<S: Surfaces + ?Sized> SampleFinder<'_, S> {
    /// Area under a sender's function, and its places: of `count` candidates spread evenly over the support's
    /// disk, those at equal steps of the area summed along a spiral.
    fn places(&self, sender: usize, count: usize) -> (f32, [SenderSample; PLACES]) {
        let point = &self.points.points[sender];
        let radius =
            SENDER_OVERLAP * self.points.levels[self.level].disk_radius * self.points.scale(point.group);
        let of_candidate = std::f32::consts::PI * radius * radius / count as f32;
        let spread = (std::f32::consts::PI / count as f32).sqrt() / ABOVE;
        let (first, second) = point.normal.any_orthonormal_pair();
        // Golden angle (Vogel 1979), turned by chance.
        let turn = Stream::new(0x706c_6163, sender as u64).unit();
        let mut found: Vec<(f32, SenderSample)> = Vec::with_capacity(count);
        let mut area = 0.0;
        for k in 0..count {
            let angle = std::f32::consts::TAU * (turn + 0.381_966_02 * k as f32).fract();
            let length = ((k as f32 + 0.5) / count as f32).sqrt();
            let along = length * (first * angle.cosine() + second * angle.sine());
            let origin = point.position + radius * (along + ABOVE * point.normal);
            let down = Ray { origin, direction: -point.normal, max_distance: 2.0 * ABOVE * radius, spread };
            let Some(hit) = self.surfaces.cast(&down, mix(sender as u64 ^ (k as u64) << 32) as u32) else {
                continue;
            };
            if !hit.faces(down.direction) || hit.group != point.group {
                continue;
            }
            let mut own = 0.0;
            let total = self.evaluator.gather(hit.position, hit.normal, hit.group, |function, weight| {
                if function as usize == sender {
                    own = weight;
                }
            });
            if own <= 0.0 || total <= LEAST_WEIGHT {
                continue;
            }
            let slope = hit.geometric_normal.dot(point.normal).max(LEAST_COSINE);
            area += own / total * of_candidate / slope;
            let covers = |finer: &Evaluator| {
                finer.gather(hit.position, hit.normal, hit.group, |_, _| {}) > LEAST_WEIGHT
            };
            let epsilon = self.surfaces.epsilon_at(hit.position);
            let place = SenderSample {
                position: hit.position + epsilon * hit.geometric_normal,
                normal: hit.normal,
                albedo: hit.albedo,
                is_handed_on: self.finer.iter().any(covers),
            };
            found.push((area, place));
        }
        let nowhere = SenderSample {
            position: point.position,
            normal: point.normal,
            albedo: Vec3::ZERO,
            is_handed_on: false,
        };
        let places = std::array::from_fn(|k| {
            let step = area * (k as f32 + 0.5) / PLACES as f32;
            let at = found.partition_point(|(summed, _)| *summed < step);
            found.get(at.min(found.len().max(1) - 1)).map_or(nowhere, |(_, place)| *place)
        });
        (area, places)
    }
}
