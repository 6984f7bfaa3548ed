//! Importance particles: points on all surfaces that light can reach the viewpoint from.
//!
//! Particles leave the viewpoint in all directions and bounce about the scene; where one meets
//! the reflecting side of a surface it leaves a candidate, but for its first few bounces, so
//! that the result depends little on where the viewpoint is (paper, section 2.3). As a camera does, they look through the
//! backs of one-sided surfaces on their way from the viewpoint, and only there.
//!
//! An object and a landscape are seen from all around, and what leaves them does not come back. There, unlike in
//! the paper, half of the particles come from the sky, and those that leave are sent back from anywhere around; at each
//! surface a particle looks for another one a few times before it leaves, and both of them are candidates. So all that
//! light bounces between has points, and what faces only the sky has none.

use super::SurfacePoint;
use super::emitter::ParticleEmitter;
use super::focus::Region;
use super::particle::{bounced, from_viewpoint};
use crate::geometry::{Hit, Ray, Surfaces};
use crate::random::{Stream, mix};
use rayon::prelude::*;

/// A particle's bounces.
const BOUNCES: u32 = 30;
/// Particles a batch.
const PARTICLES: u64 = 1024;
/// Directions in which a particle looks for another surface before it leaves an open scene.
const LOOKS: usize = 8;
/// Candidates of an open scene's first batch that are enough: of fewer, surfaces count that see no other one, too.
const ENOUGH_IN_OPEN: usize = 1536;

/// An endless, reproducible source of candidates.
pub struct Candidates<'a, S: Surfaces + ?Sized> {
    surfaces: &'a S,
    vantage: &'a ParticleEmitter,
    /// What the sky's particles go to, where that is not all of the scene.
    regions: Vec<Region>,
    seed: u64,
    next_particle: u64,
    dropped_bounces: u32,
}

impl<'a, S: Surfaces + ?Sized> Candidates<'a, S> {
    /// Candidates for the surfaces seen, directly or not, from the viewpoints, and of an open scene from the sky, from each
    /// in turn. The first three bounces are dropped, or fewer where most particles leave sooner; in an open scene the first
    /// one, or none where no surface sees another.
    pub fn new(surfaces: &'a S, vantage: &'a ParticleEmitter, seed: u64) -> Self {
        let (dropped_bounces, enough) =
            if vantage.is_open { (1, ENOUGH_IN_OPEN) } else { (3, PARTICLES as usize) };
        let regions = Vec::new();
        let mut source = Self { surfaces, vantage, regions, seed, next_particle: 0, dropped_bounces };
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

    /// Candidates for all surfaces of an open scene, most around some regions and in them: of the particles from the sky as many go to
    /// what is within any distance as to what is within twice as much.
    pub fn around(mut self, regions: &[Region]) -> Self {
        if self.vantage.is_open {
            self.regions = regions.to_vec();
            self.dropped_bounces = 0;
        }
        self
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
        let mut stream = Stream::new(self.seed, particle);
        let mut found = Vec::new();
        if self.vantage.is_open {
            self.trace_in_open(particle, &mut stream, &mut found);
        } else if let Some(&viewpoint) =
            self.vantage.viewpoints.get(particle as usize % self.vantage.viewpoints.len().max(1))
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

    /// A particle that comes from a viewpoint or from the sky, and from there again where it leaves.
    fn trace_in_open(&self, particle: u64, stream: &mut Stream, found: &mut Vec<SurfacePoint>) {
        let viewpoints = &self.vantage.viewpoints;
        let viewpoint = viewpoints.get((particle / 2) as usize % viewpoints.len().max(1));
        let mut seeing = viewpoint.filter(|_| particle % 2 == 1).map(|&v| from_viewpoint(v, stream));
        let mut ray = match seeing {
            Some(ray) => ray,
            None => self.ray_from_sky(stream),
        };
        // The surface that it is on, and how many it has bounced off before.
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

    /// Another surface that is seen from one.
    fn look(&self, from: &Hit, stream: &mut Stream) -> Option<Hit> {
        (0..LOOKS).find_map(|_| {
            let on = bounced(from, self.surfaces.epsilon_at(from.position), stream)?;
            self.cast(&on, stream)
        })
    }

    /// The nearest surface, if its side there reflects.
    fn cast(&self, ray: &Ray, stream: &mut Stream) -> Option<Hit> {
        self.surfaces.cast(ray, mix(stream.bits()) as u32).filter(|hit| hit.faces(ray.direction))
    }

    /// What is seen from a viewpoint, if its side there reflects.
    fn see(&self, ray: &Ray, stream: &mut Stream) -> Option<Hit> {
        self.surfaces.see(ray, mix(stream.bits()) as u32).filter(|hit| hit.faces(ray.direction))
    }

    fn point(&self, hit: &Hit) -> SurfacePoint {
        SurfacePoint::at(hit, self.surfaces)
    }

    /// A ray towards the scene, or what is around a region, as likely through any place as through any other, in any direction.
    fn ray_from_sky(&self, stream: &mut Stream) -> Ray {
        let (low, high) = self.surfaces.bounds();
        let mut middle = 0.5 * (low + high);
        let mut radius = 0.5 * (high - low).length();
        if !self.regions.is_empty() {
            let region = &self.regions[(stream.bits() % self.regions.len() as u64) as usize];
            middle = region.middle;
            radius = region.reach * (2.0 * radius / region.reach).max(1.0).powf(stream.unit());
        }
        let direction = stream.sphere();
        let (across, up) = direction.any_orthonormal_pair();
        let (sin, cos) = (std::f32::consts::TAU * stream.unit()).sin_cos();
        let offset = (across * cos + up * sin) * stream.unit().sqrt() - direction;
        let origin = middle + offset * radius;
        Ray::visibility(origin, direction)
    }
}
