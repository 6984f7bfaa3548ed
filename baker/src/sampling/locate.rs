//! Location of a scene's particle emitter: viewpoints, and whether the scene is open to the sky.

use super::candidates::Candidates;
use super::emitter::ParticleEmitter;
use super::particle::{bounced, from_viewpoint};
use super::viewpoint;
use crate::geometry::{Hit, Ray, Surfaces};
use crate::random::{Stream, mix};
use glam::Vec3;
use rebounce_shared::elementary::Elementary;

/// Maximum share of rays from the surfaces of a room that leave the scene; above, the scene is open. Measured: under
/// 0.04 in rooms and courts, 0.11 in a box without a front, 0.3 to 1 in objects and landscapes.
const OPEN: f32 = 0.2;
/// Minimum share of directions around the best viewpoints found that end on a surface; below, the scene is open.
/// Measured: 0.87 and more in rooms, under 0.7 in hollow or thin objects.
const ALL_AROUND: f32 = 0.75;
/// Minimum mean distance of surfaces, metres; below, the scene is open, because a person does not fit in. glTF counts
/// in metres.
const ROOMY: f32 = 0.4;
/// Minimum mean distance of surfaces, metres, and minimum share of level or upright surfaces, as floors and walls are,
/// in a room; below either limit, a scene with fronts to the outside is an object. Measured share: 0.12 in a vase, 0.8
/// and more in rooms.
const NARROW: f32 = 0.7;
const BUILT: f32 = 0.3;
/// Absolute heights of unit normals that are neither level nor upright.
const UPRIGHT: std::ops::Range<f32> = 0.1..0.99;
/// Rays towards the main part from around, and minimum share of rays that end beside the main part of a landscape.
const LANDSCAPE: (u64, f32) = (1024, 0.1);
/// Minimum share of fronts among the surfaces seen from around an object.
const SOLID: f32 = 0.95;
/// Number of test particles, and maximum number of a test particle's bounces.
const PARTICLES: u64 = 4096;
const BOUNCES: u32 = 8;

impl ParticleEmitter {
    /// Creates an emitter with these viewpoints, local space.
    pub fn at<S: Surfaces + ?Sized>(surfaces: &S, viewpoints: Vec<Vec3>, seed: u64) -> Self {
        let is_open = Outlook::new(surfaces, &viewpoints, seed).is_open() || is_landscape(surfaces, seed);
        Self { viewpoints, is_open, ..Self::default() }
    }

    /// Finds an emitter without user input. `lights` are the lamps' positions, local space, inside rooms as a rule.
    /// `None` if no reflecting side of a surface can be seen.
    pub fn find<S: Surfaces + ?Sized>(surfaces: &S, lights: &[Vec3], seed: u64) -> Option<Self> {
        let viewpoints = viewpoint::find(surfaces, lights, seed);
        let outlook = Outlook::new(surfaces, &viewpoints, seed);
        let is_open = outlook.is_open()
            || outlook.seen < ALL_AROUND
            || is_landscape(surfaces, seed)
            || (outlook.is_rounded() && is_solid(surfaces, seed));
        let emitter = Self { viewpoints, is_open, ..Self::default() };
        let sees_any = !Candidates::new(surfaces, &emitter, seed).batch().is_empty();
        sees_any.then_some(emitter)
    }
}

/// True if the main part stands on far larger geometry: rays towards the main part, from all around, end beside the
/// main part.
fn is_landscape<S: Surfaces + ?Sized>(surfaces: &S, seed: u64) -> bool {
    let (low, high) = surfaces.main_part();
    if (low, high) == surfaces.bounds() {
        return false;
    }
    let is_beside =
        |hit: &(Hit, bool)| hit.1 && (hit.0.position.cmplt(low).any() || hit.0.position.cmpgt(high).any());
    let beside = from_around(surfaces, seed).filter(is_beside).count();
    beside as f32 > LANDSCAPE.1 * LANDSCAPE.0 as f32
}

/// True if the surfaces seen from all around are fronts, as of a vase; the box of a room shows backs.
fn is_solid<S: Surfaces + ?Sized>(surfaces: &S, seed: u64) -> bool {
    let (fronts, backs): (Vec<bool>, Vec<bool>) =
        from_around(surfaces, seed).map(|hit| hit.1).partition(|front| *front);
    fronts.len() as f32 > SOLID * (fronts.len() + backs.len()) as f32
}

/// Hits of rays towards the main part, from all around, and whether the side hit reflects.
fn from_around<S: Surfaces + ?Sized>(surfaces: &S, seed: u64) -> impl Iterator<Item = (Hit, bool)> {
    let (low, high) = surfaces.main_part();
    let (middle, radius) = (0.5 * (low + high), (high - low).length());
    (0..LANDSCAPE.0).filter_map(move |i| {
        let mut stream = Stream::new(seed ^ 0x706c_6169, i);
        let direction = stream.sphere();
        let (across, up) = direction.any_orthonormal_pair();
        let (sin, cos) = (std::f32::consts::TAU * stream.unit()).sine_cosine();
        let offset = (across * cos + up * sin) * stream.unit().sqrt() - direction;
        let ray = Ray::visibility(middle + offset * radius, direction);
        let hit = surfaces.cast(&ray, mix(stream.bits()) as u32)?;
        Some((hit, hit.faces(direction)))
    })
}

/// Statistics of rays from viewpoints.
struct Outlook {
    /// Share of directions with a reflecting side.
    seen: f32,
    /// Mean distance of the reflecting sides seen, scene units.
    distance: f32,
    /// Share of rays from surfaces that leave the scene.
    left: f32,
    /// Share of level or upright surfaces among the surfaces seen.
    built: f32,
}

impl Outlook {
    fn is_open(&self) -> bool {
        self.left > OPEN || self.distance < ROOMY
    }

    /// True if the surroundings are like the inside of a vessel, not like a room.
    fn is_rounded(&self) -> bool {
        self.built < BUILT || self.distance < NARROW
    }

    fn new<S: Surfaces + ?Sized>(surfaces: &S, viewpoints: &[Vec3], seed: u64) -> Self {
        let (mut seen, mut distance, mut built) = (0u32, 0.0, 0u32);
        let (mut sent, mut left) = (0u32, 0u32);
        for (particle, viewpoint) in (0..PARTICLES).zip(viewpoints.iter().cycle()) {
            let mut stream = Stream::new(seed ^ 0x6f70_656e, particle);
            let mut ray = from_viewpoint(*viewpoint, &mut stream);
            for bounce in 0..BOUNCES {
                let seed = mix(stream.bits()) as u32;
                let hit = if bounce == 0 { surfaces.see(&ray, seed) } else { surfaces.cast(&ray, seed) };
                if bounce > 0 {
                    sent += 1;
                    left += hit.is_none() as u32;
                }
                let Some(hit) = hit.filter(|hit| hit.faces(ray.direction)) else { break };
                if bounce == 0 {
                    seen += 1;
                    distance += hit.distance;
                    let up = hit.geometric_normal.y.abs();
                    built += (!UPRIGHT.contains(&up)) as u32;
                }
                let Some(on) = bounced(&hit, surfaces.epsilon_at(hit.position), &mut stream) else { break };
                ray = on;
            }
        }
        Self {
            seen: seen as f32 / PARTICLES as f32,
            distance: distance / seen.max(1) as f32,
            left: left as f32 / sent.max(1) as f32,
            built: built as f32 / seen.max(1) as f32,
        }
    }
}
