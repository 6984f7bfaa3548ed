//! The surfaces of a scene: triangles, and exact faces where the scene has a boundary representation.

use super::brep::BrepSurfaces;
use super::mesh::{FLATTEST, OPPOSITE, PADDING, TriangleSurfaces};
use super::{Emitters, Hit, Primitives, Ray, Surfaces};
use crate::scene::Scene;
use crate::scene::detail::Exactness;
use glam::Vec3;

/// Surfaces of a scene.
pub struct SceneSurfaces {
    triangles: TriangleSurfaces,
    exact: Option<ExactPart>,
}

/// Exact faces, and what they say of the scene as a whole.
struct ExactPart {
    faces: BrepSurfaces,
    bounds: (Vec3, Vec3),
    main: (Vec3, Vec3),
    exactness: Exactness,
}

impl SceneSurfaces {
    /// Builds the surfaces of a scene, without simplification.
    pub fn from_scene(scene: &Scene) -> Self {
        Self::new(scene, TriangleSurfaces::from_scene)
    }

    /// Builds the surfaces of a scene, its triangles after [simplification](super::simplify).
    pub fn simplified(scene: &Scene) -> Self {
        Self::new(scene, TriangleSurfaces::simplified)
    }

    fn new(scene: &Scene, of_triangles: impl Fn(&Scene) -> TriangleSurfaces) -> Self {
        let triangles = of_triangles(&scene.without_tessellation());
        let exact = scene.brep.as_ref().and_then(|brep| {
            let (bounds, main) = (scene.bounds(), scene.main_part());
            let padding = PADDING * (bounds.1 - bounds.0).length();
            let faces = BrepSurfaces::new(brep, &scene.is_exact(), padding)?;
            Some(ExactPart { faces, bounds, main, exactness: Exactness::new(main, bounds) })
        });
        Self { triangles, exact }
    }

    /// The triangles, without the tessellation of exact faces.
    pub fn triangles(&self) -> &TriangleSurfaces {
        &self.triangles
    }

    /// Number of primitives, every copy counted: triangles, and pieces of exact faces.
    pub fn primitive_count(&self) -> u64 {
        self.triangles.piece_count() + self.exact.as_ref().map_or(0, |exact| exact.faces.piece_count() as u64)
    }

    /// Returns the nearer one of a hit with a triangle, if any, and of a hit with an exact face.
    #[inline]
    fn nearer(&self, faces: &BrepSurfaces, ray: &Ray, hit: Option<Hit>, is_seen: bool) -> Option<Hit> {
        let max_distance = hit.as_ref().map_or(ray.max_distance, |hit| hit.distance);
        let exact = faces.nearest(self.triangles.materials(), &Ray { max_distance, ..*ray }, is_seen);
        exact.or(hit)
    }

    /// Returns the front back to back with a back that was hit: where two parts touch, a ray hits the side towards its
    /// origin, whichever is nearer by rounding.
    #[cold]
    #[inline(never)]
    fn front_at(&self, exact: &ExactPart, ray: &Ray, seed: u32, back: &Hit) -> Option<Hit> {
        let cosine = back.normal.dot(ray.direction).max(FLATTEST);
        let max_distance = (back.distance + exact.exactness.at(back.position) / cosine).min(ray.max_distance);
        let near = Ray { max_distance, ..*ray };
        let front = self.nearer(&exact.faces, &near, self.triangles.see(&near, seed), true)?;
        (front.normal.dot(back.normal) < -OPPOSITE).then_some(front)
    }
}

impl Surfaces for SceneSurfaces {
    fn cast(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        let hit = self.triangles.cast(ray, seed);
        let Some(exact) = &self.exact else { return hit };
        let hit = self.nearer(&exact.faces, ray, hit, false)?;
        if hit.faces(ray.direction) {
            return Some(hit);
        }
        Some(self.front_at(exact, ray, seed, &hit).unwrap_or(hit))
    }

    fn see(&self, ray: &Ray, seed: u32) -> Option<Hit> {
        let hit = self.triangles.see(ray, seed);
        let Some(exact) = &self.exact else { return hit };
        self.nearer(&exact.faces, ray, hit, true)
    }

    fn transmittance(&self, from: Vec3, to: Vec3) -> Vec3 {
        if let Some(exact) = &self.exact {
            let offset = to - from;
            let length = offset.length();
            // As for triangles: a light may touch a surface.
            let limit = length - exact.exactness.near;
            if limit > 0.0 && exact.faces.is_hidden(from, offset / length, limit) {
                return Vec3::ZERO;
            }
        }
        self.triangles.transmittance(from, to)
    }

    fn tint(&self, ray: &Ray, distance: f32, from_eye: bool) -> Vec3 {
        self.triangles.tint(ray, distance, from_eye)
    }

    fn bounds(&self) -> (Vec3, Vec3) {
        self.exact.as_ref().map_or_else(|| self.triangles.bounds(), |exact| exact.bounds)
    }

    fn main_part(&self) -> (Vec3, Vec3) {
        self.exact.as_ref().map_or_else(|| self.triangles.main_part(), |exact| exact.main)
    }

    fn epsilon(&self) -> f32 {
        self.exact.as_ref().map_or_else(|| self.triangles.epsilon(), |exact| exact.exactness.near)
    }

    #[inline]
    fn epsilon_at(&self, position: Vec3) -> f32 {
        match &self.exact {
            Some(exact) => exact.exactness.at(position),
            None => self.triangles.epsilon_at(position),
        }
    }

    fn has_unlit(&self) -> bool {
        self.triangles.has_unlit()
    }

    fn primitives(&self) -> Option<&dyn Primitives> {
        // Exact faces are shaded where they are hit.
        if self.exact.is_some() { None } else { self.triangles.primitives() }
    }

    fn emitters(&self) -> Option<&dyn Emitters> {
        self.triangles.emitters()
    }
}
