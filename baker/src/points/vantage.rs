//! Where particles start, and whether the scene is open to the sky.

use super::candidates::{Candidates, bounced, from_viewpoint};
use super::viewpoint::{Sides, find};
use crate::random::{Stream, mix};
use crate::surface::Surfaces;
use glam::Vec3;

/// A scene is open if more than this share of what its surfaces send leaves it. Of rooms and courts it is under 0.04, of a
/// box without a front 0.11; of objects and landscapes 0.3 to 1.
const OPEN: f32 = 0.2;
/// Particles that tell, and their bounces.
const PARTICLES: u64 = 4096;
const BOUNCES: u32 = 8;

/// Where particles start.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vantage {
    /// Viewpoints, local space; of an open scene there may be none.
    pub viewpoints: Vec<Vec3>,
    /// Whether the scene is an object or a landscape, that light reaches from all around and leaves: no room.
    pub is_open: bool,
}

impl Vantage {
    /// These viewpoints, local space.
    pub fn at<S: Surfaces + ?Sized>(surfaces: &S, viewpoints: Vec<Vec3>, seed: u64) -> Self {
        let is_open = openness(surfaces, &viewpoints, seed) > OPEN;
        Self { viewpoints, is_open }
    }

    /// Found without help. `lights` are the lamps' places, local space, which are inside rooms as a rule. `None` where no
    /// surface's reflecting side can be seen.
    pub fn find<S: Surfaces + ?Sized>(surfaces: &S, lights: &[Vec3], seed: u64) -> Option<Self> {
        let outside = Self::at(surfaces, find(surfaces, lights, Sides::Front, seed), seed);
        if Candidates::new(surfaces, &outside, seed).has_bounces() {
            return Some(outside);
        }
        // No light goes from surface to surface but, if anywhere, between their backs.
        let viewpoints = find(surfaces, lights, Sides::Both, seed);
        if !viewpoints.is_empty() {
            return Some(Self::at(surfaces, viewpoints, seed));
        }
        let sees_any = !Candidates::new(surfaces, &outside, seed).batch().is_empty();
        sees_any.then_some(outside)
    }
}

/// The share of what surfaces send to each other and to the sky that leaves the scene; 1 where nothing is seen.
fn openness<S: Surfaces + ?Sized>(surfaces: &S, viewpoints: &[Vec3], seed: u64) -> f32 {
    let (mut sent, mut left) = (0u32, 0u32);
    for (particle, viewpoint) in (0..PARTICLES).zip(viewpoints.iter().cycle()) {
        let mut stream = Stream::new(seed ^ 0x6f70_656e, particle);
        let mut ray = from_viewpoint(*viewpoint, &mut stream);
        for bounce in 0..BOUNCES {
            let hit = surfaces.cast(&ray, mix(stream.bits()) as u32);
            if bounce > 0 {
                sent += 1;
                left += hit.is_none() as u32;
            }
            let on = hit
                .filter(|hit| hit.faces(ray.direction))
                .and_then(|hit| bounced(&hit, surfaces.epsilon(), &mut stream));
            let Some(on) = on else { break };
            ray = on;
        }
    }
    if sent == 0 { 1.0 } else { left as f32 / sent as f32 }
}
