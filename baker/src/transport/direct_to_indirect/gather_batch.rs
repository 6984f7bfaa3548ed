//! Gather batch: the rays of several receivers, cast in [sorted order](super::ray_sort) and shaded
//! (Eq. 16).
//!
//! Receivers of a batch are neighbours, so nodes, triangles, texels and functions stay in cache.
//! Results are stored by ray and summed in the order of each receiver's own rays: sums do not
//! depend on the batch.

use super::accumulator::SparseAccumulator;
use super::directions::Directions;
use super::gather_context::{GATHERED, GatherContext, GatherCost};
use super::hemisphere::{GatherRays, gather_rays};
use super::hit_cache::{HitCache, PackedWeights};
use super::ray_sort::sort;
use crate::geometry::{Primitives, SurfaceCoordinates, Surfaces};
use crate::random::{mix, unit};
use glam::{Vec3, Vec3A};

/// Rays per packet: rays cast before the lookup of their tiles, so that a step waits for distant
/// memory once per packet instead of once per ray. At most the size of a
/// [packet](Primitives::intersect_packet).
pub const BATCH: usize = 64;
/// Prefetch distance of sums, in rays.
const AHEAD: usize = 8;

/// Hit of a ray.
struct Landed {
    number: u32,
    place: SurfaceCoordinates,
    /// Distance of the hit, scene units.
    distance: f32,
    /// Tile of the hit in the hit cache.
    tile: Option<u32>,
}

/// Gather rays of several receivers and their shading results.
#[derive(Default)]
pub struct GatherBatch {
    rays: GatherRays,
    /// Index of each receiver's first ray, and the end of the last receiver's rays.
    first_rays: Vec<u32>,
    /// Ray numbers in casting order.
    order: Vec<u32>,
    /// Light that each ray sends to the sender functions.
    brought: Vec<PackedWeights>,
    /// Reciprocal hit distance of each ray; 0 without a hit.
    nearness: Vec<f32>,
    /// Hits of a packet: surface coordinates and distance.
    places: Vec<Option<(SurfaceCoordinates, f32)>>,
    /// Rays of a packet that hit a surface.
    batch: Vec<Landed>,
    /// Functions that cover a hit, with normalised weights.
    weights: Vec<(u32, f32)>,
    weighed: Vec<(u32, f32, f32)>,
}

impl GatherBatch {
    /// Casts and shades the rays of these receivers.
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
                        self.look_at(context, number, (hit.position, hit.normal, hit.group), hit.albedo);
                    }
                }
            }
        }
        self.order = order;
    }

    /// Shades a hit with its tile from the hit cache, or individually.
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
        self.look_at(context, number, (spot.position, spot.normal, spot.group), spot.albedo);
    }

    /// Shades a hit individually: evaluates the functions that cover the hit.
    #[inline(never)]
    fn look_at<S: Surfaces + ?Sized>(
        &mut self,
        context: &GatherContext<S>,
        number: u32,
        (position, normal, group): (Vec3, Vec3, u32),
        albedo: Vec3,
    ) {
        let number = number as usize;
        let arriving = Vec3A::from(albedo * self.rays.shares[number]);
        let chance = unit(mix(self.rays.rays[number].1 as u64));
        let Self { weights, weighed, .. } = self;
        context.senders.interpolate(position, normal, group, weights);
        weighed.clear();
        // Amount of the light in each sender's tint: the least-squares fit of the tint to the
        // light.
        let light = |f: u32| arriving.dot(context.duals[f as usize]);
        weighed.extend(weights.iter().map(|&(f, weight)| (f, weight, light(f))));
        self.brought[number] = match weighed.is_empty() {
            true => PackedWeights::lost(arriving.element_sum() / 3.0),
            false => PackedWeights::of(weighed, chance),
        };
    }

    /// Harmonic mean hit distance of a receiver (Ward and Heckbert 1992), scene units; infinite if
    /// no ray of the receiver hits a surface.
    pub fn distance(&self, receiver: usize) -> f32 {
        let rays = self.first_rays[receiver] as usize..self.first_rays[receiver + 1] as usize;
        rays.map(|ray| self.nearness[ray] * self.rays.shares[ray]).sum::<f32>().recip()
    }

    /// Adds the light of a receiver's rays to the sums by sender.
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
