//! Importance particles: points on all surfaces that light can reach the viewpoint from.
//!
//! Particles leave the viewpoint in all directions and bounce about the scene; where one meets
//! the reflecting side of a surface it leaves a candidate, but for its first few bounces, so
//! that the result depends little on where the viewpoint is (paper, section 2.3).
//!
//! An object and a landscape are seen from all around, and what leaves them does not come back. There, unlike in
//! the paper, the sky sends particles, too, and sends back those that leave, from anywhere; candidates are where they come
//! to from another surface. So all that light bounces to has points, and what faces only the sky has none.

use super::SurfacePoint;
use super::vantage::Vantage;
use crate::random::{Stream, mix};
use crate::surface::{Hit, Ray, Surfaces};
use glam::Vec3;
use rayon::prelude::*;

/// A particle's bounces.
const BOUNCES: u32 = 30;
/// Particles a batch.
const PARTICLES: u64 = 1024;
/// Candidates of an open scene's first batch that are enough not to take what the sky's particles come to first.
const ENOUGH_BOUNCED: usize = 32;

/// An endless, reproducible source of candidates.
pub struct Candidates<'a, S: Surfaces + ?Sized> {
    surfaces: &'a S,
    vantage: &'a Vantage,
    seed: u64,
    next_particle: u64,
    dropped_bounces: u32,
}

impl<'a, S: Surfaces + ?Sized> Candidates<'a, S> {
    /// Candidates for the surfaces seen, directly or not, from the viewpoints, and of an open scene from the sky, from each
    /// in turn. The first three bounces are dropped, or fewer where most particles leave sooner; in an open scene the first
    /// one, or none where no surface sees another.
    pub fn new(surfaces: &'a S, vantage: &'a Vantage, seed: u64) -> Self {
        let (dropped_bounces, enough) =
            if vantage.is_open { (1, ENOUGH_BOUNCED) } else { (3, PARTICLES as usize) };
        let mut source = Self { surfaces, vantage, seed, next_particle: 0, dropped_bounces };
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

    /// Whether light goes from surface to surface at all.
    pub fn has_bounces(&self) -> bool {
        self.dropped_bounces > 0
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
        let Some(mut ray) = self.start(particle, &mut stream) else { return found };
        // Surfaces that the particle has bounced off since it was sent.
        let mut bounces = 0;
        for _ in 0..BOUNCES {
            let seed = mix(stream.bits()) as u32;
            let hit = self.surfaces.cast(&ray, seed).filter(|hit| hit.faces(ray.direction));
            if let Some(hit) = &hit
                && bounces >= self.dropped_bounces
            {
                found.push(SurfacePoint::at(hit, self.surfaces.epsilon()));
            }
            match hit.and_then(|hit| bounced(&hit, self.surfaces.epsilon(), &mut stream)) {
                Some(on) => (ray, bounces) = (on, bounces + 1),
                None if self.vantage.is_open => (ray, bounces) = (self.from_sky(&mut stream), 0),
                None => break,
            }
        }
        found
    }

    /// A particle's first ray.
    fn start(&self, particle: u64, stream: &mut Stream) -> Option<Ray> {
        let Vantage { viewpoints, is_open } = self.vantage;
        let places = viewpoints.len() + *is_open as usize;
        match viewpoints.get((particle % places.max(1) as u64) as usize) {
            Some(&viewpoint) => Some(from_viewpoint(viewpoint, stream)),
            None => is_open.then(|| self.from_sky(stream)),
        }
    }

    /// A ray towards the scene, as likely through any place as through any other, in any direction.
    fn from_sky(&self, stream: &mut Stream) -> Ray {
        let (low, high) = self.surfaces.bounds();
        let radius = 0.5 * (high - low).length();
        let direction = stream.sphere();
        let (across, up) = direction.any_orthonormal_pair();
        let (sin, cos) = (std::f32::consts::TAU * stream.unit()).sin_cos();
        let offset = (across * cos + up * sin) * stream.unit().sqrt() - direction;
        let origin = 0.5 * (low + high) + offset * radius;
        Ray { origin, direction, max_distance: f32::INFINITY, spread: Ray::BLIND }
    }
}

/// A ray from a viewpoint, in any direction.
pub(super) fn from_viewpoint(viewpoint: Vec3, stream: &mut Stream) -> Ray {
    Ray { origin: viewpoint, direction: stream.sphere(), max_distance: f32::INFINITY, spread: Ray::BLIND }
}

/// The ray that goes on from where one ended, by the cosine; `None` where the shading normal allows a direction that
/// points into the surface.
pub(super) fn bounced(hit: &Hit, epsilon: f32, stream: &mut Stream) -> Option<Ray> {
    let direction = stream.cosine_hemisphere(hit.normal);
    let origin = hit.offset_origin(direction, epsilon);
    let ray = Ray { origin, direction, max_distance: f32::INFINITY, spread: Ray::BLIND };
    (direction.dot(hit.geometric_normal) > 0.0).then_some(ray)
}
