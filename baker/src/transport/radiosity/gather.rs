//! Gather: irradiance of receivers by the rays of their hemispheres (the report, section 6.3, procedure GATHER).
//!
//! All groups share the rays. At a hit the senders' irradiance is evaluated at the [level](super::sender_level) that looks
//! small enough, and reflected by channel with the surface's reflectance: the light of a known lamp has a known colour, so
//! that no tint stands in for it.

use super::ancestors::Ancestors;
use super::direct::GroupField;
use super::sender_level::{SenderLevels, SurfacePlace};
use crate::basis::FetchStep;
use crate::geometry::{Primitives, SurfaceCoordinates, Surfaces};
use crate::job::clock;
use crate::sampling::Points;
use crate::transport::direct_to_indirect::accumulator::SparseAccumulator;
use crate::transport::direct_to_indirect::directions::Directions;
use crate::transport::direct_to_indirect::hemisphere::{GatherRays, gather_rays};
use crate::transport::direct_to_indirect::ray_sort::sort;
use glam::Vec3;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// Rays per packet.
const PACKET: usize = 64;
/// Rays that are sorted and cast together, in whole receivers.
const TOGETHER: usize = 1 << 12;

/// Irradiance of a receiver from the coarse points, by channel: (sender, irradiance per unit irradiance), senders ascending.
pub type ChannelRow = Vec<(u32, Vec3)>;

/// Time of all threads together, nanoseconds.
#[derive(Debug, Default)]
pub struct GatherTime {
    /// In casting rays.
    rays: AtomicU64,
    /// In evaluating functions, with the surfaces' colours.
    functions: AtomicU64,
}

impl GatherTime {
    /// Seconds of all threads together: in casting rays, and in evaluating functions.
    pub fn seconds(&self) -> [f64; 2] {
        [&self.rays, &self.functions].map(|time| time.load(Ordering::Relaxed) as f64 * 1e-9)
    }

    fn add(&self, rays: Duration, functions: Duration) {
        self.rays.fetch_add(rays.as_nanos() as u64, Ordering::Relaxed);
        self.functions.fetch_add(functions.as_nanos() as u64, Ordering::Relaxed);
    }
}

/// Hit of a ray.
struct Met {
    /// Number of the receiver among those gathered together.
    receiver: u32,
    distance: f32,
    place: SurfacePlace,
    /// Reflectance times the ray's share of the irradiance.
    reflected: Vec3,
}

/// Working memory of a thread.
#[derive(Default)]
pub struct GatherMemory {
    rays: GatherRays,
    owners: Vec<u32>,
    order: Vec<u32>,
    places: Vec<Option<(SurfaceCoordinates, f32)>>,
    met: Vec<Met>,
    weights: Vec<(u32, f32)>,
}

/// Inputs of all gathers.
pub struct FieldGather<'a, S: ?Sized> {
    /// Surfaces of the scene.
    pub surfaces: &'a S,
    /// All points.
    pub points: &'a Points,
    /// Functions that light leaves from.
    pub senders: &'a SenderLevels,
    /// Seed of all random numbers.
    pub seed: u64,
    /// Time spent.
    pub time: &'a GatherTime,
}

impl<S: Surfaces + ?Sized> FieldGather<'_, S> {
    /// Number of receivers that are gathered for together.
    pub fn batch_size(directions: &Directions) -> usize {
        (TOGETHER / directions.len().max(1)).max(1)
    }

    /// Casts the rays of some receivers; calls `met` with each hit, in an order that depends on the receivers alone.
    fn cast(
        &self,
        receivers: &[usize],
        directions: &Directions,
        memory: &mut GatherMemory,
        mut met: impl FnMut(&Met, &mut Vec<(u32, f32)>),
    ) {
        let GatherMemory { rays, owners, order, places, met: found, weights } = memory;
        rays.clear();
        owners.clear();
        for (number, &i) in (0u32..).zip(receivers) {
            let point = &self.points.points[i];
            gather_rays(point, i, self.seed, self.surfaces.epsilon_at(point.position), directions, rays);
            owners.resize(rays.rays.len(), number);
        }
        sort(&rays.cells, order);
        let mut began = clock::wall();
        for packet in order.chunks(PACKET) {
            found.clear();
            match self.surfaces.primitives() {
                Some(primitives) => {
                    primitives.intersect_packet(&rays.rays, packet, places);
                }
                None => places.clear(),
            }
            let cast = clock::wall();
            match self.surfaces.primitives() {
                Some(primitives) => landed(primitives, rays, owners, packet, places, found),
                None => self.cast_each(rays, owners, packet, found),
            }
            // Steps wait for distant memory once per packet, not once per hit.
            for step in [FetchStep::Bucket, FetchStep::List, FetchStep::Functions] {
                found.iter().for_each(|hit| self.senders.fetch(hit.distance, hit.place.position, step));
            }
            found.iter().for_each(|hit| met(hit, weights));
            let done = clock::wall();
            self.time.add(cast.saturating_sub(began), done.saturating_sub(cast));
            began = done;
        }
    }

    fn cast_each(&self, rays: &GatherRays, owners: &[u32], packet: &[u32], found: &mut Vec<Met>) {
        for &number in packet {
            let (ray, seed) = &rays.rays[number as usize];
            let hit = self.surfaces.cast(ray, *seed).filter(|hit| hit.faces(ray.direction));
            if let Some(hit) = hit.filter(|hit| hit.albedo != Vec3::ZERO) {
                found.push(Met {
                    receiver: owners[number as usize],
                    distance: hit.distance,
                    place: SurfacePlace { position: hit.position, normal: hit.normal, group: hit.group },
                    reflected: hit.albedo * rays.shares[number as usize],
                });
            }
        }
    }

    /// Gathers a field: the irradiance of each receiver by group, receiver after receiver, and the variance of its
    /// brightness.
    pub fn field(
        &self,
        receivers: &[usize],
        directions: &Directions,
        field: &GroupField,
        memory: &mut GatherMemory,
    ) -> Vec<(Vec3, f32)> {
        let groups = field.groups;
        let mut out = vec![(Vec3::ZERO, 0.0); receivers.len() * groups];
        self.cast(receivers, directions, memory, |hit, weights| {
            self.senders.interpolate(hit.distance, &hit.place, weights);
            let sums = &mut out[hit.receiver as usize * groups..][..groups];
            for (group, (sum, squares)) in sums.iter_mut().enumerate() {
                let light = |(sender, weight): &(u32, f32)| *weight * field.at(*sender as usize)[group];
                let arriving = hit.reflected * weights.iter().map(light).sum::<Vec3>();
                *sum += arriving;
                *squares += brightness(arriving).powi(2);
            }
        });
        // Variance of a sum of rays with a random direction each; that of a lattice is smaller.
        let rays = directions.len() as f32;
        out.iter_mut()
            .for_each(|(sum, squares)| *squares = (*squares - brightness(*sum).powi(2) / rays).max(0.0));
        out
    }

    /// Gathers a field for one receiver, and its row of irradiance from the coarse points. Bounced light of finer senders is
    /// interpolated from their coarse `ancestors`.
    pub fn field_and_row(
        &self,
        receiver: usize,
        directions: &Directions,
        field: &GroupField,
        ancestors: &Ancestors,
        (memory, row): (&mut GatherMemory, &mut SparseAccumulator<3>),
    ) -> (Vec<Vec3>, ChannelRow) {
        let mut out = vec![Vec3::ZERO; field.groups];
        self.cast(&[receiver], directions, memory, |hit, weights| {
            self.senders.interpolate(hit.distance, &hit.place, weights);
            add_field(field, weights, hit.reflected, &mut out);
            for (sender, weight) in weights.iter() {
                ancestors.each(*sender, |coarse, share| {
                    row.add_each(coarse as usize, (*weight * share * hit.reflected).to_array());
                });
            }
        });
        let mut found = ChannelRow::new();
        row.each(|sender, amount| found.push((sender, Vec3::from(amount))));
        row.clear();
        (out, found)
    }
}

/// Mean of the channels.
pub fn brightness(irradiance: Vec3) -> f32 {
    irradiance.element_sum() / 3.0
}

/// Adds the light that some functions of a field reflect.
#[inline]
fn add_field(field: &GroupField, weights: &[(u32, f32)], reflected: Vec3, sums: &mut [Vec3]) {
    for (sender, weight) in weights {
        let share = *weight * reflected;
        for (sum, irradiance) in sums.iter_mut().zip(field.at(*sender as usize)) {
            *sum += share * *irradiance;
        }
    }
}

/// Reads the surfaces where the rays of a packet hit.
fn landed(
    primitives: &dyn Primitives,
    rays: &GatherRays,
    owners: &[u32],
    packet: &[u32],
    places: &[Option<(SurfaceCoordinates, f32)>],
    found: &mut Vec<Met>,
) {
    for (&number, place) in packet.iter().zip(places) {
        let Some((place, distance)) = *place else { continue };
        let at = number as usize;
        let spot = primitives.spot(place, (rays.rays[at].0.spread * distance).powi(2));
        found.push(Met {
            receiver: owners[at],
            distance,
            place: SurfacePlace { position: spot.position, normal: spot.normal, group: spot.group },
            reflected: spot.albedo * rays.shares[at],
        });
    }
}
