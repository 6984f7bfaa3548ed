//! Importance particles: points on all surfaces that light can reach the viewpoint from.
//!
//! Particles leave the viewpoint in all directions and bounce about the scene; where one meets
//! the reflecting side of a surface it leaves a candidate, but for its first few bounces, so
//! that the result depends little on where the viewpoint is (paper, section 2.3).

use super::SurfacePoint;
use crate::random::{Stream, mix};
use crate::surface::{Ray, Surfaces};
use glam::Vec3;
use rayon::prelude::*;

/// A particle's bounces.
const BOUNCES: u32 = 30;
/// Particles a batch.
const PARTICLES: u64 = 1024;

/// An endless, reproducible source of candidates.
pub struct Candidates<'a, S: Surfaces + ?Sized> {
    surfaces: &'a S,
    viewpoints: &'a [Vec3],
    seed: u64,
    next_particle: u64,
    dropped_bounces: u32,
}

impl<'a, S: Surfaces + ?Sized> Candidates<'a, S> {
    /// Candidates for the surfaces seen, directly or not, from the `viewpoints` (local space), from
    /// each in turn. The first three bounces are dropped, or fewer where most particles leave an open
    /// scene sooner.
    pub fn new(surfaces: &'a S, viewpoints: &'a [Vec3], seed: u64) -> Self {
        let mut source = Self { surfaces, viewpoints, seed, next_particle: 0, dropped_bounces: 3 };
        while source.dropped_bounces > 0 {
            let found = source.batch().len() as u64;
            source.next_particle = 0;
            if found >= PARTICLES {
                break;
            }
            source.dropped_bounces -= 1;
        }
        source
    }

    /// The first particle that has not been traced.
    pub fn next_particle(&self) -> u64 {
        self.next_particle
    }

    /// Goes on with this particle.
    pub fn go_on_at(&mut self, particle: u64) {
        self.next_particle = particle;
    }

    /// The next candidates, in a fixed order; empty where particles find nothing.
    pub fn batch(&mut self) -> Vec<SurfacePoint> {
        let first = self.next_particle;
        self.next_particle += PARTICLES;
        let paths: Vec<Vec<SurfacePoint>> =
            (first..first + PARTICLES).into_par_iter().map(|particle| self.trace(particle)).collect();
        paths.concat()
    }

    fn trace(&self, particle: u64) -> Vec<SurfacePoint> {
        let mut found = Vec::new();
        let mut stream = Stream::new(self.seed, particle);
        let Some(&origin) = self.viewpoints.get(particle as usize % self.viewpoints.len().max(1)) else {
            return found;
        };
        let mut ray =
            Ray { origin, direction: stream.sphere(), max_distance: f32::INFINITY, spread: Ray::BLIND };
        for bounce in 0..BOUNCES {
            let seed = mix(stream.bits()) as u32;
            let Some(hit) = self.surfaces.cast(&ray, seed) else { break };
            if !hit.faces(ray.direction) {
                break;
            }
            if bounce >= self.dropped_bounces {
                found.push(SurfacePoint::at(&hit, self.surfaces.epsilon()));
            }
            let direction = stream.cosine_hemisphere(hit.normal);
            // A direction that the shading normal allows may still point into the surface.
            if direction.dot(hit.geometric_normal) <= 0.0 {
                break;
            }
            ray.origin = hit.offset_origin(direction, self.surfaces.epsilon());
            ray.direction = direction;
        }
        found
    }
}
