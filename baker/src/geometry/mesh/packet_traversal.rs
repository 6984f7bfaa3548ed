//! Packet traversal of a BVH8 (Wald et al. 2001; interval culling after Boulos et al. 2006).
//!
//! The eight children of a node are tested against the interval bounds of the packet; then a passing child is tested
//! against the active rays, eight rays at a time. A triangle is tested against the rays with a hit of the leaf's box.
//! A ray that diverges from the packet continues by single-ray traversal. Invariant: a ray finds the hit of single-ray
//! traversal, to the last bit. The triangle test has the same arithmetic, no hit is before the triangle's box by more
//! than rounding, and of two triangles at equal distance the first counts.

use super::blas::{Blas, Nearest, NearestSoFar};
use super::geometry::Surface;
use super::packet::{MOST, Packet, Rays};
use super::triangle::TriangleHit;
use crate::geometry::Ray;
use crate::geometry::bvh8::{LEAF, SlabRay8, WIDTH, distance, entry, move_half, places};
use crate::lanes::{F32x8, LANES, LaneKernel, dispatch};

/// Capacity of the traversal stack without heap memory; in tests small enough to overflow often.
const WAITING: usize = if cfg!(test) { 2 * WIDTH } else { 128 };

/// Nearest hit by ray: the triangle's index in leaf order, and the hit.
pub(super) type Firsts = [Option<(usize, TriangleHit)>; MOST];

/// A child on the traversal stack.
#[derive(Clone, Copy, Default)]
struct Waiting {
    /// Distance to the child's box, and the child's name: index of the parent node, and index of the child in the
    /// parent.
    entry: u64,
    /// Rays with a hit of the parent.
    rays: Rays,
}

/// Number of bits of a child's index in the parent.
const PLACE_BITS: u32 = WIDTH.trailing_zeros();

/// State of a packet traversal.
struct Together<'a, V> {
    blas: &'a Blas,
    surfaces: &'a [Surface],
    packet: Packet<V>,
    seeds: [u32; MOST],
    found: Firsts,
}

impl Blas {
    /// [`Blas::nearest`], not strictly, for at most [`MOST`] rays of one [class](Ray::octant_and_axis), with seeds.
    #[inline]
    pub fn nearest_together<'r>(
        &self,
        surfaces: &[Surface],
        rays: impl Iterator<Item = &'r (Ray, u32)> + Clone,
        class: u8,
    ) -> Firsts {
        dispatch(NearestTogether { blas: self, surfaces, rays, class })
    }
}

/// Arguments of [`Blas::nearest_together`].
pub(super) struct NearestTogether<'a, R> {
    pub blas: &'a Blas,
    pub surfaces: &'a [Surface],
    pub rays: R,
    pub class: u8,
}

impl<'r, R: Iterator<Item = &'r (Ray, u32)> + Clone> LaneKernel for NearestTogether<'_, R> {
    type Output = Firsts;

    #[inline(always)]
    fn run<V: F32x8>(self) -> Firsts {
        let Self { blas, surfaces, rays, class } = self;
        if blas.bvh.nodes.is_empty() {
            return [None; MOST];
        }
        let mut seeds = [0; MOST];
        seeds.iter_mut().zip(rays.clone()).for_each(|(of, (_, seed))| *of = *seed);
        let packet = Packet::<V>::new(rays.map(|(ray, _)| ray), class);
        let mut walk = Together { blas, surfaces, packet, seeds, found: [None; MOST] };
        walk.all();
        walk.found
    }
}

/// Arguments of [`Together::alone`].
struct SingleRay<'t, 'a, V> {
    packet: &'t mut Together<'a, V>,
    from: u32,
    ray: usize,
}

impl<V: F32x8> LaneKernel for SingleRay<'_, '_, V> {
    type Output = ();

    #[inline(always)]
    fn run<W: F32x8>(self) {
        self.packet.alone::<W>(self.from, self.ray);
    }
}

impl<V: F32x8> Together<'_, V> {
    #[inline(always)]
    fn all(&mut self) {
        let nodes = self.blas.bvh.nodes.as_slice();
        let (mut waiting, mut count) = ([Waiting::default(); WAITING], 0);
        let mut farther: Vec<Waiting> = Vec::new();
        let (mut open, mut rays) = (0, Rays::MAX);
        loop {
            let (near, mut met) = nodes[open as usize].meet_any(&self.packet);
            if count + WIDTH > WAITING {
                count = move_half(&mut waiting, &mut farther, count);
            }
            // Insertion sort, nearest child last: few children are hit.
            let from = count;
            while met != 0 {
                let child = met.trailing_zeros();
                met &= met - 1;
                let waits = Waiting { entry: entry(open << PLACE_BITS | child, near[child as usize]), rays };
                let mut place = count;
                // The remainders change nothing; they show that the index is in range.
                while place > from && waiting[(place - 1) % WAITING].entry < waits.entry {
                    waiting[place % WAITING] = waiting[(place - 1) % WAITING];
                    place -= 1;
                }
                waiting[place % WAITING] = waits;
                count += 1;
            }
            (open, rays) = loop {
                let next = if count > 0 {
                    count -= 1;
                    waiting[count % WAITING]
                } else {
                    let Some(next) = farther.pop() else { return };
                    next
                };
                if distance(next.entry) > self.packet.limits.farthest() {
                    continue;
                }
                let name = next.entry as u32;
                let (node, child) = (&nodes[(name >> PLACE_BITS) as usize], name as usize % WIDTH);
                let rays = node.meet_child(child, &self.packet, next.rays);
                let next = node.children[child];
                if rays == 0 {
                    continue;
                }
                if next & LEAF != 0 {
                    self.leaf(next, rays);
                } else if rays & (rays - 1) != 0 {
                    break (next, rays);
                } else {
                    V::enter(SingleRay { packet: self, from: next, ray: rays.trailing_zeros() as usize });
                }
                self.packet.limits.find_farthest();
            };
        }
    }

    /// Tests rays against a leaf's triangles.
    #[inline(always)]
    fn leaf(&mut self, leaf: u32, mut rays: Rays) {
        let corners = self.blas.corners.as_slice();
        while rays != 0 {
            let (names, count, sheared) = self.packet.take_eight(&mut rays);
            let mut limits: [f32; LANES] = names.map(|ray| self.packet.limits.of(ray));
            for place in places(leaf) {
                let meetings = corners[place].meet_together(&sheared, limits, (1 << count) - 1);
                let mut met = meetings.met;
                while met != 0 {
                    let lane = met.trailing_zeros() as usize % LANES;
                    met &= met - 1;
                    let ray = names[lane];
                    let meeting = match meetings.unclear >> lane & 1 {
                        0 => Some(meetings.of(lane)),
                        _ => self.meet_alone(place, ray),
                    };
                    if let Some(meeting) = meeting {
                        let mut stop = self.stop(ray);
                        limits[lane] = stop.take(place, meeting, limits[lane]);
                        self.found[ray] = stop.best;
                        self.packet.limits.set(ray, limits[lane]);
                    }
                }
            }
        }
    }

    /// Returns the nearest-hit query of a ray.
    #[inline]
    fn stop(&self, ray: usize) -> NearestSoFar<'_> {
        let &Self { blas, surfaces, .. } = self;
        NearestSoFar { blas, surfaces, strictly: false, seed: self.seeds[ray], best: self.found[ray] }
    }

    /// Tests a triangle against a single ray, after a result made unclear by rounding.
    #[cold]
    #[inline(never)]
    fn meet_alone(&self, place: usize, ray: usize) -> Option<TriangleHit> {
        self.blas.corners[place].meet(&self.packet.alone(ray).1, self.packet.limits.of(ray))
    }

    /// Continues the traversal of a single ray from a node on.
    #[inline(always)]
    fn alone<W: F32x8>(&mut self, from: u32, ray: usize) {
        let (walker, sheared) = self.packet.alone(ray);
        let mut nearest = Nearest { stop: self.stop(ray), sheared };
        let (walker, limit) = (SlabRay8::<W>::new(&walker), self.packet.limits.of(ray));
        let limit = self.blas.bvh.walk_by(&walker, from, limit, &mut nearest);
        self.found[ray] = nearest.stop.best;
        self.packet.limits.set(ray, limit);
    }
}
