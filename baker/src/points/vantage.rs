//! Where particles start, and whether the scene is open to the sky.

use super::candidates::{Candidates, bounced, from_viewpoint};
use super::viewpoint;
use crate::random::{Stream, mix};
use crate::surface::Surfaces;
use glam::Vec3;

/// A scene is open if more than this share of what its surfaces send leaves it. Of rooms and courts it is under 0.04, of a
/// box without a front 0.11; of objects and landscapes 0.3 to 1.
const OPEN: f32 = 0.2;
/// Or if fewer of the directions around the best viewpoints that can be found end on a surface: in rooms 0.87 and more, in
/// whatever is hollow or thin under 0.7.
const ALL_AROUND: f32 = 0.75;
/// Or if surfaces are nearer than so many metres on average: nobody fits in. glTF counts in metres.
const ROOMY: f32 = 0.4;
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
    /// In a room, local space.
    pub fn within(viewpoint: Vec3) -> Self {
        Self { viewpoints: vec![viewpoint], is_open: false }
    }

    /// These viewpoints, local space.
    pub fn at<S: Surfaces + ?Sized>(surfaces: &S, viewpoints: Vec<Vec3>, seed: u64) -> Self {
        let is_open = Outlook::new(surfaces, &viewpoints, seed).is_open();
        Self { viewpoints, is_open }
    }

    /// Found without help. `lights` are the lamps' places, local space, which are inside rooms as a rule. `None` where no
    /// surface's reflecting side can be seen.
    pub fn find<S: Surfaces + ?Sized>(surfaces: &S, lights: &[Vec3], seed: u64) -> Option<Self> {
        let viewpoints = viewpoint::find(surfaces, lights, seed);
        let outlook = Outlook::new(surfaces, &viewpoints, seed);
        let vantage = Self { viewpoints, is_open: outlook.is_open() || outlook.seen < ALL_AROUND };
        let sees_any = !Candidates::new(surfaces, &vantage, seed).batch().is_empty();
        sees_any.then_some(vantage)
    }
}

/// What is seen from some viewpoints.
struct Outlook {
    /// The share of directions in which a reflecting side is.
    seen: f32,
    /// How far away that is on average, scene units.
    distance: f32,
    /// The share of what surfaces send to each other and to the sky that leaves the scene.
    left: f32,
}

impl Outlook {
    fn is_open(&self) -> bool {
        self.left > OPEN || self.distance < ROOMY
    }

    fn new<S: Surfaces + ?Sized>(surfaces: &S, viewpoints: &[Vec3], seed: u64) -> Self {
        let (mut seen, mut distance) = (0u32, 0.0);
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
                }
                let Some(on) = bounced(&hit, surfaces.epsilon(), &mut stream) else { break };
                ray = on;
            }
        }
        Self {
            seen: seen as f32 / PARTICLES as f32,
            distance: distance / seen.max(1) as f32,
            left: left as f32 / sent.max(1) as f32,
        }
    }
}
