//! Triangles that shine.

use super::blas::Blas;
use super::geometry::Surface;
use super::tlas::Tlas;
use super::{LocatedTriangle, TriangleSurfaces};
use crate::geometry::{EmissiveTriangle, Emitters};
use glam::Vec3;

/// Returns whether a material shines; unlit surfaces are shown bright, but shine on nothing.
fn shines(surface: &Surface) -> bool {
    surface.emission != Vec3::ZERO && !surface.is_unlit
}

/// Returns the numbers of the primitives that shine, ascending.
pub(super) fn shining(alone: &Blas, models: &[Blas], instances: &Tlas, surfaces: &[Surface]) -> Vec<u32> {
    if !surfaces.iter().any(shines) {
        return Vec::new();
    }
    let of = |blas: &Blas| -> Vec<u32> {
        let is_shining = |i: &u32| shines(&surfaces[blas.attributes[*i as usize].material as usize]);
        (0..blas.attributes.len() as u32).filter(is_shining).collect()
    };
    let models: Vec<Vec<u32>> = models.iter().map(of).collect();
    let mut out = of(alone);
    for copy in &instances.all {
        out.extend(models[copy.model as usize].iter().map(|triangle| copy.first_primitive + triangle));
    }
    out
}

impl TriangleSurfaces {
    /// Returns the number of a triangle among the emitters; `None` if it does not shine.
    #[inline]
    pub(super) fn emitter_at(&self, found: &LocatedTriangle) -> Option<u32> {
        let first = found.copy.map_or(0, |copy| copy.first_primitive);
        self.shining.binary_search(&(first + found.triangle as u32)).ok().map(|number| number as u32)
    }
}

impl Emitters for TriangleSurfaces {
    fn emitter_count(&self) -> usize {
        self.shining.len()
    }

    fn emitter(&self, number: u32) -> EmissiveTriangle {
        let found = self.found(self.shining[number as usize]);
        let look = &found.blas.attributes[found.triangle];
        let surface = &self.surfaces[look.material as usize];
        let spanned = found.front();
        let share = look.share(spanned) * 0.5 * spanned.length();
        EmissiveTriangle {
            corners: found.blas.corners[found.triangle].positions().map(|corner| found.place(corner)),
            is_two_sided: surface.double_sided,
            material: look.material,
            mean: surface.shine(look.uv([1.0 / 3.0; 3]), share),
        }
    }

    fn radiance(&self, number: u32, weights: [f32; 3], direction: Vec3) -> Vec3 {
        let found = self.found(self.shining[number as usize]);
        let look = &found.blas.attributes[found.triangle];
        let surface = &self.surfaces[look.material as usize];
        // As shading has it.
        let normal = found.normal(weights);
        if normal != Vec3::ZERO && normal.dot(direction) >= 0.0 && !surface.double_sided {
            return Vec3::ZERO;
        }
        let uv = look.uv(weights);
        let color = found.blas.color(&self.surfaces, found.triangle, weights);
        surface.shine(uv, 0.0) * surface.opacity(color, uv)
    }
}
