//! Where points must be fine: where somebody looks, and from where light goes there.
//!
//! One disk radius for a whole scene gives a plain nearly all functions and the house on it none. So each place has a
//! radius of its own, which grows with the distance from what is looked at, as meshes are graded: what views see needs
//! functions that are equally large in them; what they do not see may be as coarse as a share of its distance from there,
//! since from so far away its light looks as fine. A level has points only where its radius is needed, and further,
//! coarser levels reach the scene's ends.
//!
//! Rooms, which people walk about in, and all scenes that one radius is nearly right for, keep one radius.

use super::SurfacePoint;
use super::emitter::{ParticleEmitter, View};
use super::poisson_disk::DartBoard;
use crate::geometry::{Ray, Surfaces};
use crate::random::{Stream, mix};
use glam::Vec3;

/// Needed radius over the distance from what is looked at, where nobody looks.
const GRADE: f32 = 0.2;
/// Radii differ from place to place where the finest would be so much smaller than one radius for all; and wherever a
/// part has the detail, whose candidates tell nothing of how large all else is.
pub const WORTH_IT: f32 = 3.0;
/// A level has points where its radius is at most so many times finer than needed.
const FINER: f32 = std::f32::consts::SQRT_2;
/// Rays of all views together, and of each at least.
const RAYS: [usize; 2] = [4096, 128];
/// Rays of which so few meet a surface are no view.
const LEAST_SEEN: usize = 8;
/// Regions reach this far around what a ray meets, over its distance.
const AROUND: f32 = 0.15;
/// How much coarser than in view functions are around what is in view.
const BESIDE: f32 = 2.0;
/// Least cosine that a surface's slant counts by.
const LEAST_COSINE: f32 = 0.02;
/// The part that has the detail is as fine as this much around it.
const ROOM: f32 = 1.1;

/// A ball within which functions are equally fine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Its middle, local space.
    pub middle: Vec3,
    /// Its radius, scene units.
    pub reach: f32,
    /// Needed radius of functions over the finest that is needed anywhere; at least 1.
    scale: f32,
}

impl Region {
    /// How far a place is outside of it, scene units.
    fn beyond(&self, place: Vec3) -> f32 {
        (place.distance(self.middle) - self.reach).max(0.0)
    }
}

/// What is looked at from a vantage; empty in rooms, and where nobody looks anywhere and no part has the detail.
pub fn regions<S: Surfaces + ?Sized>(surfaces: &S, vantage: &ParticleEmitter, seed: u64) -> Vec<Region> {
    if !vantage.is_open {
        return Vec::new();
    }
    let rays = (RAYS[0] / vantage.views.len().max(1)).max(RAYS[1]);
    let seen = vantage.views.iter().map(|view| Seen::new(surfaces, view, rays, seed));
    let seen: Vec<Seen> = seen.filter(|seen| seen.meetings.len() >= LEAST_SEEN).collect();
    if seen.is_empty() {
        let (low, high) = surfaces.main_part();
        let is_part = (low, high) != surfaces.bounds();
        let reach = 0.5 * ROOM * (high - low).length();
        return is_part
            .then_some(Region { middle: 0.5 * (low + high), reach, scale: 1.0 })
            .into_iter()
            .collect();
    }
    let mut distances: Vec<f32> = seen.iter().flat_map(Seen::distances).collect();
    let usual = middle_of(&mut distances);
    let scaled = |scale: f32| (scale / usual).max(1.0);
    let mut found: Vec<Region> = Vec::new();
    let of_meetings = seen.iter().flat_map(|seen| &seen.meetings).map(|meeting| Region {
        middle: meeting.position,
        reach: AROUND * meeting.distance,
        scale: scaled(meeting.distance / meeting.cosine.max(LEAST_COSINE).sqrt()),
    });
    let around = seen.iter().map(|seen| Region {
        middle: seen.middle,
        reach: seen.distance,
        scale: BESIDE * scaled(seen.distance),
    });
    let mut all: Vec<Region> = of_meetings.chain(around).collect();
    all.sort_by(|a, b| a.scale.total_cmp(&b.scale));
    for region in all {
        // What is within a finer one is fine enough.
        let is_within = |other: &Region| {
            let offset = other.middle.distance(region.middle);
            offset <= other.reach
                && (region.reach < 2.0 * other.reach || offset + region.reach <= other.reach)
        };
        if !found.iter().any(is_within) {
            found.push(region);
        }
    }
    found
}

/// Where a ray of a view ends.
struct Meeting {
    position: Vec3,
    distance: f32,
    /// Between the ray and the surface's normal.
    cosine: f32,
}

/// What a view sees.
struct Seen {
    meetings: Vec<Meeting>,
    /// How far away it usually is, scene units.
    distance: f32,
    /// Its middle, local space.
    middle: Vec3,
}

impl Seen {
    fn new<S: Surfaces + ?Sized>(surfaces: &S, view: &View, rays: usize, seed: u64) -> Self {
        let meeting = |i: u64| {
            let mut stream = Stream::new(seed ^ 0x6c6f_6f6b, i);
            let direction = view.direction(&mut stream);
            let hit = surfaces.cast(&Ray::visibility(view.position, direction), mix(stream.bits()) as u32)?;
            let cosine = hit.geometric_normal.dot(direction).abs();
            Some(Meeting { position: hit.position, distance: hit.distance, cosine })
        };
        let meetings: Vec<Meeting> = (0..rays as u64).filter_map(meeting).collect();
        let mut distances: Vec<f32> = meetings.iter().map(|meeting| meeting.distance).collect();
        let distance = if distances.is_empty() { 0.0 } else { middle_of(&mut distances) };
        Self { meetings, distance, middle: view.position + view.towards * distance }
    }

    fn distances(&self) -> impl Iterator<Item = f32> + '_ {
        self.meetings.iter().map(|meeting| meeting.distance)
    }
}

/// The median of some numbers, at least one.
fn middle_of(numbers: &mut [f32]) -> f32 {
    let middle = numbers.len() / 2;
    numbers.select_nth_unstable_by(middle, f32::total_cmp).1.max(f32::MIN_POSITIVE)
}

/// The radius of functions that each place needs.
#[derive(Clone, Debug, PartialEq)]
pub struct Focus {
    regions: Vec<Region>,
    /// The smallest, scene units.
    finest: f32,
}

impl Focus {
    /// Such that there are about `count` functions of `coarser` times the needed radii; `None` where the finest radius would
    /// be over `most`. `pool` are places all over the scene, most where it is fine.
    pub fn new(
        regions: Vec<Region>,
        pool: &[SurfacePoint],
        count: usize,
        coarser: f32,
        most: f32,
    ) -> Option<Self> {
        let thrown = |finest: f32| Focus { regions: regions.clone(), finest }.count(pool, coarser, 4 * count);
        if regions.is_empty() || thrown(most) > count {
            return None;
        }
        let (mut small, mut large) = (most * 1e-6, most);
        for _ in 0..16 {
            let middle = (small * large).sqrt();
            if thrown(middle) > count { small = middle } else { large = middle }
        }
        Some(Self { regions, finest: large })
    }

    /// The smallest needed radius, scene units.
    pub fn finest(&self) -> f32 {
        self.finest
    }

    /// The regions.
    pub fn regions(&self) -> &[Region] {
        &self.regions
    }

    /// The radius that a place needs, scene units.
    pub fn needed(&self, place: Vec3) -> f32 {
        let of = |region: &Region| self.finest * region.scale + GRADE * region.beyond(place);
        self.regions.iter().map(of).fold(f32::INFINITY, f32::min)
    }

    /// Whether a place needs functions of this disk radius.
    pub fn needs(&self, place: Vec3, radius: f32) -> bool {
        let most = FINER * radius;
        let of = |region: &Region| self.finest * region.scale + GRADE * region.beyond(place) <= most;
        self.regions.iter().any(of)
    }

    /// How many functions of `coarser` times the needed radii stand among the places of `pool`; of more than `most`, so many.
    fn count(&self, pool: &[SurfacePoint], coarser: f32, most: usize) -> usize {
        let mut boards: Vec<DartBoard> = Vec::new();
        let mut count = 0;
        for candidate in pool {
            let level = (self.needed(candidate.position) / self.finest).log2().round().max(0.0) as usize;
            while boards.len() <= level {
                boards.push(DartBoard::new(coarser * self.finest * (1u64 << boards.len().min(63)) as f32));
            }
            if boards[level].is_free(candidate) {
                boards[level].insert(*candidate);
                count += 1;
                if count > most {
                    break;
                }
            }
        }
        count
    }
}
