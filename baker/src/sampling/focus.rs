//! Local disk radii: fine in the views, and around the views, from where light reaches the viewed surfaces.
//!
//! With one disk radius for a whole scene, a plain has nearly all functions and the house on the plain none. Therefore
//! each place has a radius of its own, graded by the distance from the viewed regions like a mesh. Functions in view
//! have equal sizes in the picture; outside the views the radius may be a share of the distance from the viewed
//! regions, since light from that distance looks equally fine. A level has points only where its radius is needed, and
//! additional, coarser levels reach the ends of the scene.
//!
//! Rooms, in which people walk about, and scenes with a nearly suitable single radius keep one radius.

use super::SurfacePoint;
use super::emitter::{ParticleEmitter, View};
use super::poisson_disk::DartBoard;
use crate::geometry::{Ray, Surfaces};
use crate::random::{Stream, mix};
use glam::Vec3;
use rebounce_shared::elementary::Elementary;

/// Needed radius over the distance from the viewed regions, outside the views.
const GRADE: f32 = 0.2;
/// Minimum ratio of the uniform radius to the finest radius; below, a scene keeps the uniform radius. Radii always
/// differ from place to place in a scene with a [main part](crate::scene::detail), because candidates in the main part
/// do not show the size of the rest.
pub const WORTH_IT: f32 = 3.0;
/// Maximum needed radius over the disk radius of a level's points.
const FINER: f32 = std::f32::consts::SQRT_2;
/// Rays of all views together, and minimum number of rays per view.
const RAYS: [usize; 2] = [4096, 128];
/// Minimum number of hits of a view; views with fewer hits are dropped.
const LEAST_SEEN: usize = 8;
/// Radius of a region around a hit, over the hit's distance.
const AROUND: f32 = 0.15;
/// Radius of functions around a view over the radius in the view.
const BESIDE: f32 = 2.0;
/// Lower limit of the cosine between a ray and the surface normal.
const LEAST_COSINE: f32 = 0.02;
/// Diameter of the region around the main part, over the main part's diagonal.
const ROOM: f32 = 1.1;

/// A ball with one needed radius of functions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Region {
    /// Centre, local space.
    pub middle: Vec3,
    /// Radius, scene units.
    pub reach: f32,
    /// Needed radius of functions in the ball over the finest needed radius of the scene; at least 1.
    scale: f32,
}

impl Region {
    /// Distance of a place from the ball, scene units; 0 inside.
    fn beyond(&self, place: Vec3) -> f32 {
        (place.distance(self.middle) - self.reach).max(0.0)
    }
}

/// Viewed regions of an emitter. Empty in rooms; without views, the main part; empty without a main part.
pub fn regions<S: Surfaces + ?Sized>(surfaces: &S, emitter: &ParticleEmitter, seed: u64) -> Vec<Region> {
    if !emitter.is_open {
        return Vec::new();
    }
    let rays = (RAYS[0] / emitter.views.len().max(1)).max(RAYS[1]);
    let seen = emitter.views.iter().map(|view| ViewSurvey::new(surfaces, view, rays, seed));
    let seen: Vec<ViewSurvey> = seen.filter(|seen| seen.meetings.len() >= LEAST_SEEN).collect();
    if seen.is_empty() {
        let (low, high) = surfaces.main_part();
        let is_part = (low, high) != surfaces.bounds();
        let reach = 0.5 * ROOM * (high - low).length();
        return is_part
            .then_some(Region { middle: 0.5 * (low + high), reach, scale: 1.0 })
            .into_iter()
            .collect();
    }
    let mut distances: Vec<f32> = seen.iter().flat_map(ViewSurvey::distances).collect();
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
        // A region within a finer region adds nothing.
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

/// Hit of a view's ray.
struct ViewHit {
    position: Vec3,
    distance: f32,
    /// Absolute cosine between the ray and the surface's normal.
    cosine: f32,
}

/// Hits of a view.
struct ViewSurvey {
    meetings: Vec<ViewHit>,
    /// Median distance of the hits, scene units.
    distance: f32,
    /// Point at the median distance in the view's direction, local space.
    middle: Vec3,
}

impl ViewSurvey {
    fn new<S: Surfaces + ?Sized>(surfaces: &S, view: &View, rays: usize, seed: u64) -> Self {
        let meeting = |i: u64| {
            let mut stream = Stream::new(seed ^ 0x6c6f_6f6b, i);
            let direction = view.direction(&mut stream);
            let hit = surfaces.cast(&Ray::visibility(view.position, direction), mix(stream.bits()) as u32)?;
            let cosine = hit.geometric_normal.dot(direction).abs();
            Some(ViewHit { position: hit.position, distance: hit.distance, cosine })
        };
        let meetings: Vec<ViewHit> = (0..rays as u64).filter_map(meeting).collect();
        let mut distances: Vec<f32> = meetings.iter().map(|meeting| meeting.distance).collect();
        let distance = if distances.is_empty() { 0.0 } else { middle_of(&mut distances) };
        Self { meetings, distance, middle: view.position + view.towards * distance }
    }

    fn distances(&self) -> impl Iterator<Item = f32> + '_ {
        self.meetings.iter().map(|meeting| meeting.distance)
    }
}

/// Median of at least one number.
fn middle_of(numbers: &mut [f32]) -> f32 {
    let middle = numbers.len() / 2;
    numbers.select_nth_unstable_by(middle, f32::total_cmp).1.max(f32::MIN_POSITIVE)
}

/// Needed radius of functions, by place.
#[derive(Clone, Debug, PartialEq)]
pub struct Focus {
    regions: Vec<Region>,
    /// Smallest needed radius, scene units.
    finest: f32,
}

impl Focus {
    /// Chooses the finest radius for about `count` functions of `coarser` times the needed radii; `None` without
    /// regions, or if the finest radius would exceed `most`. `pool`: places all over the scene, densest in the fine
    /// regions.
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

    /// Smallest needed radius, scene units.
    pub fn finest(&self) -> f32 {
        self.finest
    }

    /// Needed radius at a place, scene units.
    pub fn needed(&self, place: Vec3) -> f32 {
        let of = |region: &Region| self.finest * region.scale + GRADE * region.beyond(place);
        self.regions.iter().map(of).fold(f32::INFINITY, f32::min)
    }

    /// True if a place needs functions of this disk radius.
    pub fn needs(&self, place: Vec3, radius: f32) -> bool {
        let most = FINER * radius;
        let of = |region: &Region| self.finest * region.scale + GRADE * region.beyond(place) <= most;
        self.regions.iter().any(of)
    }

    /// Number of functions of `coarser` times the needed radii that fit onto the places of `pool`; counting ends above
    /// `most`.
    fn count(&self, pool: &[SurfacePoint], coarser: f32, most: usize) -> usize {
        let mut boards: Vec<DartBoard> = Vec::new();
        let mut count = 0;
        for candidate in pool {
            let level =
                (self.needed(candidate.position) / self.finest).logarithm2().round().max(0.0) as usize;
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
