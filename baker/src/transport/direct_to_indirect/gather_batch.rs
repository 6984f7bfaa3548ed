//! Gather batch: the rays of several receivers, cast in [sorted order](super::ray_sort) and shaded (Eq. 16).
//!
//! Receivers of a batch are neighbours, so that nodes, triangles, texels and functions are in cache. Results are kept by ray
//! and added up in the order of each receiver's own rays: sums do not depend on the batch.

use super::accumulator::SparseAccumulator;
use super::directions::Directions;
use super::gather_context::{GATHERED, GatherContext, GatherCost};
use super::hemisphere::{GatherRays, gather_rays};
use super::hit_cache::{HitCache, PackedWeights};
use super::ray_sort::sort;
use crate::geometry::{Primitives, SurfaceCoordinates, Surfaces};
use crate::random::{mix, unit};
use glam::{Vec3, Vec3A};

/// Rays that are cast before their tiles are looked at, so that one step waits for memory far away once, not once a ray; as
/// many as [walk together](Primitives::intersect_packet) at most.
pub const BATCH: usize = 64;
/// Rays by which sums are asked for before they are added to.
const AHEAD: usize = 8;

/// Where a ray ended.
struct Landed {
    number: u32,
    place: SurfaceCoordinates,
    /// Scene units.
    distance: f32,
    /// The senders' tile there.
    tile: Option<u32>,
}

/// Rays of some receivers, and what they find.
#[derive(Default)]
pub struct GatherBatch {
    rays: GatherRays,
    /// Where each receiver's rays begin, and one past the end.
    first_rays: Vec<u32>,
    /// The rays in the order that they are cast.
    order: Vec<u32>,
    /// What each ray brings to the senders.
    brought: Vec<PackedWeights>,
    /// One over the length of each ray, 0 where it hits nothing.
    nearness: Vec<f32>,
    /// Where the rays of a batch end.
    places: Vec<Option<(SurfaceCoordinates, f32)>>,
    /// Rays of a batch that hit something.
    batch: Vec<Landed>,
    /// The functions that cover one hit.
    weights: Vec<(u32, f32)>,
    weighed: Vec<(u32, f32, f32)>,
}

impl GatherBatch {
    /// Casts the rays of these receivers.
    pub fn cast<S: Surfaces + ?Sized>(
        &mut self,
        context: &GatherContext<S>,
        receivers: &[usize],
        directions: &Directions,
    ) {
        self.rays.clear();
        self.first_rays.clear();
        for &i in receivers {
            self.first_rays.push(self.rays.rays.len() as u32);
            let point = &context.points.points[i];
            let epsilon = context.surfaces.epsilon_at(point.position);
            gather_rays(point, i, context.settings.seed, epsilon, directions, &mut self.rays);
        }
        self.first_rays.push(self.rays.rays.len() as u32);
        self.brought.clear();
        self.brought.resize(self.rays.rays.len(), PackedWeights::NOTHING);
        self.nearness.clear();
        self.nearness.resize(self.rays.rays.len(), 0.0);
        sort(&self.rays.cells, &mut self.order);
        let order = std::mem::take(&mut self.order);
        match (context.surfaces.primitives(), context.tiles) {
            (Some(primitives), Some(tiles)) => {
                let mut batch = std::mem::take(&mut self.batch);
                let mut places = std::mem::take(&mut self.places);
                for some in order.chunks(BATCH) {
                    batch.clear();
                    primitives.intersect_packet(&self.rays.rays, some, &mut places);
                    batch.extend(some.iter().zip(&places).filter_map(|(&number, place)| {
                        let (place, distance) = (*place)?;
                        tiles.fetch_piece(place.primitive);
                        Some(Landed { number, place, distance, tile: None })
                    }));
                    for landed in &mut batch {
                        landed.tile = tiles.number(landed.place, landed.distance);
                        landed.tile.inspect(|tile| tiles.fetch_shares(*tile));
                    }
                    for landed in &batch {
                        self.nearness[landed.number as usize] = landed.distance.recip();
                        self.take(context, primitives, tiles, landed);
                    }
                }
                (self.batch, self.places) = (batch, places);
            }
            _ => {
                for &number in &order {
                    let (ray, seed) = &self.rays.rays[number as usize];
                    let hit = context.surfaces.cast(ray, *seed);
                    if let Some(hit) = hit.filter(|hit| hit.albedo != Vec3::ZERO && hit.faces(ray.direction))
                    {
                        self.nearness[number as usize] = hit.position.distance(ray.origin).recip();
                        self.look_at(context, number, hit.position, hit.normal, hit.albedo);
                    }
                }
            }
        }
        self.order = order;
    }

    /// Takes what the tiles have where a ray ended, or looks at the place itself.
    #[inline]
    fn take<S: Surfaces + ?Sized>(
        &mut self,
        context: &GatherContext<S>,
        primitives: &dyn Primitives,
        tiles: &HitCache,
        landed: &Landed,
    ) {
        let &Landed { number, place, distance, tile } = landed;
        let at = number as usize;
        if let Some(shares) = tile.and_then(|tile| tiles.shares(tile)) {
            self.brought[at] = shares.scaled(self.rays.shares[at]);
            return;
        }
        let spread = self.rays.rays[at].0.spread;
        let spot = primitives.spot(place, (spread * distance).powi(2));
        self.look_at(context, number, spot.position, spot.normal, spot.albedo);
    }

    /// Looks for the functions that cover what one ray hits.
    #[inline(never)]
    fn look_at<S: Surfaces + ?Sized>(
        &mut self,
        context: &GatherContext<S>,
        number: u32,
        position: Vec3,
        normal: Vec3,
        albedo: Vec3,
    ) {
        let number = number as usize;
        let arriving = Vec3A::from(albedo * self.rays.shares[number]);
        let chance = unit(mix(self.rays.rays[number].1 as u64));
        let Self { weights, weighed, .. } = self;
        context.senders.interpolate(position, normal, weights);
        weighed.clear();
        // As bright as the light is counted in each sender's tint: the best fit of the one to the other.
        let light = |f: u32| arriving.dot(context.duals[f as usize]);
        weighed.extend(weights.iter().map(|&(f, weight)| (f, weight, light(f))));
        self.brought[number] = match weighed.is_empty() {
            true => PackedWeights::lost(arriving.element_sum() / 3.0),
            false => PackedWeights::of(weighed, chance),
        };
    }

    /// The harmonic mean distance of what one of the receivers sees (Ward and Heckbert 1992), scene units; infinite where its
    /// rays hit nothing.
    pub fn distance(&self, receiver: usize) -> f32 {
        let rays = self.first_rays[receiver] as usize..self.first_rays[receiver + 1] as usize;
        rays.map(|ray| self.nearness[ray] * self.rays.shares[ray]).sum::<f32>().recip()
    }

    /// Adds up what the rays of one of the receivers brought, by sender.
    pub fn add(&self, receiver: usize, senders: &mut SparseAccumulator<2>) -> GatherCost {
        let mut cost = GatherCost::default();
        let rays = self.first_rays[receiver] as usize..self.first_rays[receiver + 1] as usize;
        for (number, brought) in rays.clone().zip(&self.brought[rays]) {
            if let Some(soon) = self.brought.get(number + AHEAD) {
                soon.each(|sender, _| senders.fetch(sender));
            }
            let sum = brought.sum() as f64;
            cost.seen += sum;
            if brought.is_lost() {
                cost.lost += sum;
            }
            brought.each(|sender, amount| senders.add(GATHERED, sender, amount));
        }
        cost
    }
}
