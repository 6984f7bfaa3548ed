//! Emissive triangles by number: the primitives whose material emits light.

use super::{LocatedTriangle, TriangleSurfaces};
use crate::geometry::emitters::{Emitter, Emitters};
use glam::{Vec2, Vec3};

impl TriangleSurfaces {
    /// Returns the numbers of the primitives with emission: first those without instances, then copy after copy.
    pub(super) fn find_emitters(&self) -> Vec<u32> {
        if !self.surfaces.iter().any(|surface| surface.emission != Vec3::ZERO && !surface.is_unlit) {
            return Vec::new();
        }
        let shines = |primitive: &u32| {
            let LocatedTriangle { blas, triangle, .. } = self.found(*primitive);
            let surface = &self.surfaces[blas.attributes[triangle].material as usize];
            surface.emission != Vec3::ZERO && !surface.is_unlit
        };
        let mut found: Vec<u32> =
            (0..self.primitives.min(u64::from(u32::MAX)) as u32).filter(shines).collect();
        // Triangles where an emission texture is black.
        found.retain(|primitive| self.emitter_of(*primitive).radiance != Vec3::ZERO);
        found
    }

    fn emitter_of(&self, primitive: u32) -> Emitter {
        let found = self.found(primitive);
        let LocatedTriangle { blas, triangle, .. } = found;
        let (look, corners) = (&blas.attributes[triangle], blas.corners[triangle].positions());
        let surface = &self.surfaces[look.material as usize];
        let spanned = found.front();
        let area = 0.5 * spanned.length();
        Emitter {
            corners: corners.map(|corner| found.place(corner)),
            is_two_sided: surface.double_sided,
            material: look.material,
            radiance: surface.shine(look.uv([1.0 / 3.0; 3]), look.share(spanned) * area),
        }
    }
}

impl Emitters for TriangleSurfaces {
    fn emitter_count(&self) -> usize {
        self.emitters.len()
    }

    fn emitter(&self, number: usize) -> Emitter {
        self.emitter_of(self.emitters[number])
    }

    fn radiance(&self, number: usize, at: Vec2, area: f32) -> Vec3 {
        let found = self.found(self.emitters[number]);
        let look = &found.blas.attributes[found.triangle];
        let surface = &self.surfaces[look.material as usize];
        surface.shine(look.uv([1.0 - at.x - at.y, at.x, at.y]), look.share(found.front()) * area)
    }
}
