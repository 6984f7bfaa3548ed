//! What the rays of some receivers find (Eq. 16).
//!
//! Rays are cast in the order of their directions, not of their receivers: receivers next to each other see the same
//! things, so that nodes, triangles, texels and functions are still near when they are wanted again. What is found is
//! kept by ray, and added up in the order of a receiver's own rays: the sums are those of one receiver alone.

use super::directions::Directions;
use super::gather::{GatherContext, GatherCost};
use super::hemisphere::{GatherRays, gather_rays};
use super::tally::Tally;
use crate::basis::List;
use crate::surface::{Hit, Ray, Surfaces};
use glam::{Vec2, Vec3, Vec3A};
use rebounce_shared::octahedral;

/// Rays that are cast before their hits are looked at, so that one step waits for memory far away once, not once a ray.
const BATCH: usize = 64;
/// Cells of directions along each axis of the octahedral map: a power of two.
const CELLS: u32 = 32;

/// What a ray brings.
#[derive(Clone, Copy, Debug, Default)]
struct Brought {
    /// Cosine-weighted reflectance.
    seen: f32,
    /// Whether no sender covers what it hit.
    is_lost: bool,
    /// Where its shares begin and end.
    senders: [u32; 2],
    /// The same among the coarse functions.
    coarse: [u32; 2],
}

/// Rays of some receivers, and what they find.
#[derive(Default)]
pub struct Found {
    rays: GatherRays,
    /// Where each receiver's rays begin, and one past the end.
    first_rays: Vec<u32>,
    /// The rays in the order that they are cast.
    order: Vec<u32>,
    brought: Vec<Brought>,
    /// Irradiance by function.
    shares: Vec<(u32, f32)>,
    batch: Batch,
}

/// Working memory of the rays that are cast together.
#[derive(Default)]
struct Batch {
    /// Hits that reflect: the ray, what it hits, and the light that it brings.
    reflecting: Vec<(u32, Hit, Vec3A)>,
    /// Where the functions that may cover each of them are listed.
    lists: Vec<List>,
    /// The functions that cover one hit.
    weights: Vec<(u32, f32)>,
}

impl Found {
    /// Casts the rays of these receivers.
    pub fn cast<S: Surfaces + ?Sized>(
        &mut self,
        context: &GatherContext<S>,
        receivers: &[usize],
        directions: &Directions,
    ) {
        self.rays.clear();
        self.first_rays.clear();
        self.shares.clear();
        // The first ray that may need coarse functions is known by its receiver: points are ordered by level.
        let mut coarse_rays = 0;
        for &i in receivers {
            self.first_rays.push(self.rays.rays.len() as u32);
            let (point, epsilon) = (&context.points.points[i], context.surfaces.epsilon());
            gather_rays(point, i, context.settings.seed, epsilon, directions, &mut self.rays);
            if i < context.coarse_count {
                coarse_rays = self.rays.rays.len();
            }
        }
        self.first_rays.push(self.rays.rays.len() as u32);
        self.brought.clear();
        self.brought.resize(self.rays.rays.len(), Brought::default());
        sort(&self.rays.rays, &mut self.order);
        for order in self.order.chunks(BATCH) {
            let Batch { reflecting, lists, weights } = &mut self.batch;
            reflecting.clear();
            for &number in order {
                let (ray, seed) = &self.rays.rays[number as usize];
                if let Some(hit) = context.surfaces.cast(ray, *seed)
                    && hit.albedo != Vec3::ZERO
                    && hit.faces(ray.direction)
                {
                    let arriving = Vec3A::from(hit.albedo * self.rays.shares[number as usize]);
                    reflecting.push((number, hit, arriving));
                }
            }
            // All lists are asked for before the first one is waited for.
            lists.clear();
            lists.extend(reflecting.iter().map(|(_, hit, _)| context.senders.look_up(hit.position)));
            for ((ray, hit, arriving), list) in reflecting.iter().zip(&*lists) {
                let shares = &mut self.shares;
                let mut share = |weights: &[(u32, f32)]| {
                    let first = shares.len() as u32;
                    // As bright as the light is counted in each sender's tint: the best fit of the one to the other.
                    let amount =
                        |&(f, share): &(u32, f32)| (f, share * arriving.dot(context.duals[f as usize]));
                    shares.extend(weights.iter().map(amount));
                    [first, shares.len() as u32]
                };
                let brought = &mut self.brought[*ray as usize];
                brought.seen = arriving.element_sum() / 3.0;
                context.senders.interpolate_in(*list, hit.position, hit.normal, weights);
                brought.is_lost = weights.is_empty();
                brought.senders = share(weights);
                if !brought.is_lost && (*ray as usize) < coarse_rays {
                    context.coarse.interpolate(hit.position, hit.normal, weights);
                    brought.coarse = share(weights);
                }
            }
        }
    }

    /// Adds up what the rays of one of the receivers brought, by sender and by coarse function.
    pub fn add(&self, receiver: usize, senders: &mut Tally, coarse: &mut Tally) -> GatherCost {
        let mut cost = GatherCost::default();
        let rays = self.first_rays[receiver] as usize..self.first_rays[receiver + 1] as usize;
        for brought in &self.brought[rays] {
            cost.seen += brought.seen as f64;
            if brought.is_lost {
                cost.lost += brought.seen as f64;
            }
            let of = |[first, end]: [u32; 2]| &self.shares[first as usize..end as usize];
            of(brought.senders).iter().for_each(|(sender, amount)| senders.add(*sender as usize, *amount));
            of(brought.coarse).iter().for_each(|(sender, amount)| coarse.add(*sender as usize, *amount));
        }
        cost
    }
}

/// Replaces `order` by the rays' numbers in the order of their directions along a curve over the sphere; rays that go
/// alike keep their order.
fn sort(rays: &[(Ray, u32)], order: &mut Vec<u32>) {
    let mut ends = [0u32; (CELLS * CELLS) as usize];
    for (ray, _) in rays {
        ends[cell(ray.direction)] += 1;
    }
    let mut next = 0;
    for end in &mut ends {
        let count = std::mem::replace(end, next);
        next += count;
    }
    order.clear();
    order.resize(rays.len(), 0);
    for (number, (ray, _)) in rays.iter().enumerate() {
        let place = &mut ends[cell(ray.direction)];
        order[*place as usize] = number as u32;
        *place += 1;
    }
}

/// The cell of a unit direction, along a Morton curve over the octahedral map.
#[inline]
fn cell(direction: Vec3) -> usize {
    let place = (octahedral::encode(direction) + Vec2::ONE) * (0.5 * CELLS as f32);
    let spread = |x: f32| {
        let x = (x as u32).min(CELLS - 1);
        let x = (x | x << 4) & 0x0f0f;
        let x = (x | x << 2) & 0x3333;
        (x | x << 1) & 0x5555
    };
    (spread(place.x) | spread(place.y) << 1) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Stream;

    #[test]
    fn rays_that_go_alike_are_cast_together_and_in_their_order() {
        let mut stream = Stream::new(5, 0);
        let rays: Vec<(Ray, u32)> = (0..5_000)
            .map(|i| {
                let direction = stream.sphere();
                (Ray { origin: Vec3::ZERO, direction, max_distance: f32::INFINITY, spread: 0.0 }, i)
            })
            .collect();
        let mut order = Vec::new();
        for some in [&rays[..0], &rays[..1], &rays] {
            sort(some, &mut order);
            assert_eq!(order.len(), some.len());
            let direction = |ray: u32| some[ray as usize].0.direction;
            let mut far = 0;
            for pair in order.windows(2) {
                let key = |ray: u32| (cell(direction(ray)), ray);
                assert!(key(pair[0]) < key(pair[1]));
                far += (direction(pair[0]).dot(direction(pair[1])) < 0.8) as usize;
            }
            // The curve over the sphere has few jumps.
            assert!(far * 20 <= order.len(), "{far}");
        }
    }
}
