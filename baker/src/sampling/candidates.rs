//! Importance particles: points on all surfaces from which light can reach the viewpoint.
//!
//! Particles leave the viewpoint in all directions and bounce about the scene. Every hit of the reflecting side of a
//! surface becomes a candidate. The first few bounces are dropped, so that the result depends little on the position of
//! the viewpoint (paper, section 2.3). Like a camera, particles look through the backs of one-sided surfaces on the
//! first ray from the viewpoint, and only there.
//!
//! An open scene (an object or a landscape) is seen from all around, and light that leaves does not return. There,
//! unlike in the paper, half of the particles start from the sky, and particles that leave the scene start again from a
//! random direction around. At a surface a particle tries several directions for a hit with another surface before
//! leaving, and both surfaces become candidates. So all surfaces that exchange light have points, and surfaces that
//! face only the sky have none, unless the emitter [asks](ParticleEmitter::faces_sky) for them.

use super::SurfacePoint;
use super::emitter::ParticleEmitter;
use super::focus::Region;
use super::particle::{bounced, from_viewpoint};
use crate::geometry::{Hit, Ray, Surfaces};
use crate::random::{Stream, mix};
use rayon::prelude::*;
use rebounce_shared::elementary::Elementary;

/// Maximum number of bounces of a particle.
const BOUNCES: u32 = 30;
/// Particles per batch.
const PARTICLES: u64 = 1024;
/// Directions tried for a hit with another surface before a particle leaves an open scene.
const LOOKS: usize = 8;
/// Minimum number of candidates in an open scene's first batch; with fewer, surfaces that see no other surface count
/// too.
const ENOUGH_IN_OPEN: usize = 1536;

/// Endless, reproducible source of candidates.
pub struct Candidates<'a, S: Surfaces + ?Sized> {
    surfaces: &'a S,
    emitter: &'a ParticleEmitter,
    /// Targets of particles from the sky; empty if the target is the whole scene.
    regions: Vec<Region>,
    seed: u64,
    next_particle: u64,
    dropped_bounces: u32,
}

impl<'a, S: Surfaces + ?Sized> Candidates<'a, S> {
    /// Creates a source of candidates on the surfaces seen, directly or indirectly, from the viewpoints in turn, and in
    /// an open scene also from the sky. Drops the first three bounces, or fewer if the majority of particles leave
    /// sooner; in an open scene the first bounce, or none if no surface sees another.
    pub fn new(surfaces: &'a S, emitter: &'a ParticleEmitter, seed: u64) -> Self {
        let (dropped_bounces, enough) = match (emitter.is_open, emitter.faces_sky) {
            (true, true) => (0, 0),
            (true, false) => (1, ENOUGH_IN_OPEN),
            (false, _) => (3, PARTICLES as usize),
        };
        let regions = Vec::new();
        let mut source = Self { surfaces, emitter, regions, seed, next_particle: 0, dropped_bounces };
        while source.dropped_bounces > 0 {
            let found = source.batch().len();
            source.next_particle = 0;
            if found >= enough {
                break;
            }
            source.dropped_bounces -= 1;
        }
        source
    }

    /// Covers all surfaces of an open scene, densest in and around `regions`. The target radius of a particle from the
    /// sky is uniform in its logarithm, from the region's radius to the scene's diagonal: every doubling of the radius
    /// receives equally many particles.
    pub fn around(mut self, regions: &[Region]) -> Self {
        if self.emitter.is_open {
            self.regions = regions.to_vec();
            self.dropped_bounces = 0;
        }
        self
    }

    /// Index of the first particle not yet traced.
    pub fn next_particle(&self) -> u64 {
        self.next_particle
    }

    /// Continues with this particle.
    pub fn go_on_at(&mut self, particle: u64) {
        self.next_particle = particle;
    }

    /// Returns the next candidates, in a fixed order; empty if no particle hits a surface.
    pub fn batch(&mut self) -> Vec<SurfacePoint> {
        let first = self.next_particle;
        self.next_particle += PARTICLES;
        let paths: Vec<Vec<SurfacePoint>> =
            (first..first + PARTICLES).into_par_iter().map(|particle| self.trace(particle)).collect();
        paths.concat()
    }

    fn trace(&self, particle: u64) -> Vec<SurfacePoint> {
        let mut stream = Stream::new(self.seed, particle);
        let mut found = Vec::new();
        if self.emitter.is_open {
            self.trace_in_open(particle, &mut stream, &mut found);
        } else if let Some(&viewpoint) =
            self.emitter.viewpoints.get(particle as usize % self.emitter.viewpoints.len().max(1))
        {
            let mut ray = from_viewpoint(viewpoint, &mut stream);
            for bounce in 0..BOUNCES {
                let hit =
                    if bounce == 0 { self.see(&ray, &mut stream) } else { self.cast(&ray, &mut stream) };
                let Some(hit) = hit else { break };
                if bounce >= self.dropped_bounces {
                    found.push(self.point(&hit));
                }
                let Some(on) = bounced(&hit, self.surfaces.epsilon_at(hit.position), &mut stream) else {
                    break;
                };
                ray = on;
            }
        }
        found
    }

    /// Traces a particle from a viewpoint or from the sky; restarts from the sky after leaving the scene.
    fn trace_in_open(&self, particle: u64, stream: &mut Stream, found: &mut Vec<SurfacePoint>) {
        let viewpoints = &self.emitter.viewpoints;
        let viewpoint = viewpoints.get((particle / 2) as usize % viewpoints.len().max(1));
        let mut seeing = viewpoint.filter(|_| particle % 2 == 1).map(|&v| from_viewpoint(v, stream));
        let mut ray = match seeing {
            Some(ray) => ray,
            None => self.ray_from_sky(stream),
        };
        // The surface last hit, and the number of bounces before that hit.
        let mut here: Option<(Hit, u32)> = None;
        for _ in 0..BOUNCES {
            let next = match &here {
                None => match seeing.take() {
                    Some(ray) => self.see(&ray, stream),
                    None => self.cast(&ray, stream),
                }
                .map(|hit| (hit, 0)),
                Some((hit, bounces)) => self.look(hit, stream).map(|hit| (hit, bounces + 1)),
            };
            if let Some((hit, bounces)) = &next {
                if let Some((first, 0)) = &here
                    && self.dropped_bounces > 0
                {
                    found.push(self.point(first));
                }
                if *bounces >= self.dropped_bounces {
                    found.push(self.point(hit));
                }
            } else {
                ray = self.ray_from_sky(stream);
            }
            here = next;
        }
    }

    /// Looks for a hit with another surface from a hit.
    fn look(&self, from: &Hit, stream: &mut Stream) -> Option<Hit> {
        (0..LOOKS).find_map(|_| {
            let on = bounced(from, self.surfaces.epsilon_at(from.position), stream)?;
            self.cast(&on, stream)
        })
    }

    /// Returns the nearest hit, if the side hit reflects.
    fn cast(&self, ray: &Ray, stream: &mut Stream) -> Option<Hit> {
        self.surfaces.cast(ray, mix(stream.bits()) as u32).filter(|hit| hit.faces(ray.direction))
    }

    /// Returns the nearest hit seen from a viewpoint, if the side hit reflects.
    fn see(&self, ray: &Ray, stream: &mut Stream) -> Option<Hit> {
        self.surfaces.see(ray, mix(stream.bits()) as u32).filter(|hit| hit.faces(ray.direction))
    }

    fn point(&self, hit: &Hit) -> SurfacePoint {
        SurfacePoint::at(hit, self.surfaces)
    }

    /// Returns a ray towards the scene or the surroundings of a region, uniform over positions and directions.
    fn ray_from_sky(&self, stream: &mut Stream) -> Ray {
        let (low, high) = self.surfaces.bounds();
        let mut middle = 0.5 * (low + high);
        let mut radius = 0.5 * (high - low).length();
        if !self.regions.is_empty() {
            let region = &self.regions[(stream.bits() % self.regions.len() as u64) as usize];
            middle = region.middle;
            radius = region.reach * (2.0 * radius / region.reach).max(1.0).power(stream.unit());
        }
        let direction = stream.sphere();
        let (across, up) = direction.any_orthonormal_pair();
        let (sin, cos) = (std::f32::consts::TAU * stream.unit()).sine_cosine();
        let offset = (across * cos + up * sin) * stream.unit().sqrt() - direction;
        let origin = middle + offset * radius;
        Ray::visibility(origin, direction)
    }
}
